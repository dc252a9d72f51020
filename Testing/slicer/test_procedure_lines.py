"""A procedure's lines, error arrows and table in the scene, also after saving and opening it."""

from dataclasses import replace

import numpy as np
import pytest
from coloraide import Color
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer import transforms
from rastrainer.procedure.errors import analyze_procedure, true_lines
from rastrainer.slicer.scene.nodes import Role, worldPoints
from rastrainer.slicer.scene.procedure_lines import showPlannedLines, showProcedureErrors
from rastrainer_simulator.flow.session.plan_marks import PLACED, PLANNED, SHOWN
from rastrainer_simulator.presentation.look import TONES
from Testing.domain.procedure.made_up_procedure import made_up_meshes, made_up_procedure, trajectory
from Testing.domain.procedure.procedure_records import recorded, rotation
from Testing.slicer.scene_bundle import load_bundle

ROLES = (Role.PLANNED_LINE, Role.REGISTERED_LINE, Role.TRUE_LINE)


@pytest.fixture(scope="module")
def analysis():
    """Two lines with the errors of a registration, and of a hand that stopped 2 mm too early."""
    random = np.random.default_rng(4)
    truth = transforms.rigid(rotation(random, 90.0), random.normal(0.0, 100.0, 3))
    off = transforms.rigid(rotation(random, 2.0), np.array([0.4, -0.7, 0.5]))
    procedure = made_up_procedure()
    done = recorded(procedure, truth @ off, depth=60.0)
    first, *others = done.instruments
    done = replace(done, instruments=(replace(first, self_aligned=True), *others))
    return analyze_procedure(done, procedure, made_up_meshes(), truth), true_lines(done, truth)


def lines(scene, role):
    return [worldPoints(node) for node in role.all(scene)]


def column(scene, name):
    table = Role.PROCEDURE_ERRORS.find(scene).GetTable()
    return vtk_to_numpy(table.GetColumnByName(name))


def check(scene, found):
    planned, registered, true = (lines(scene, role) for role in ROLES)
    assert len(planned) == len(registered) == len(true) == len(found.trajectories)
    rows = zip(found.trajectories, planned, registered, true, strict=True)
    for row, (errors, plan, shown, placed) in enumerate(rows):
        for cause, begin, end in (
            ("", plan, placed),
            (", by registration", plan, shown),
            (", by hand or robot", shown, placed),
        ):
            length = np.linalg.norm(end[1] - begin[1])
            in_table = column(scene, f"target point error{cause} (mm)")[row]
            assert in_table == pytest.approx(length, abs=1e-4)
        assert np.linalg.norm(shown[1] - shown[0]) == pytest.approx(
            np.linalg.norm(plan[1] - plan[0])
        )
        assert column(scene, "plunge depth (mm)")[row] == pytest.approx(errors.plunge_mm, abs=1e-3)


def test_lines_arrows_and_table_show_the_same_errors_in_the_colors_of_the_simulators_views(
    scene, analysis
):
    found = analysis[0]
    showProcedureErrors(scene, *analysis)
    check(scene, found)
    aligned = Role.PROCEDURE_ERRORS.find(scene).GetTable()
    first, second = map(aligned.GetColumnByName("aligned by").GetValue, (0, 1))
    assert (first, second) == ("robot", "hand")
    assert all(node.GetLocked() for role in ROLES for node in role.all(scene))
    for role, tone in zip(ROLES, (PLANNED, SHOWN, PLACED), strict=True):
        color = role.all(scene)[0].GetDisplayNode().GetSelectedColor()
        assert color == pytest.approx(Color(TONES[tone]).coords(), abs=1e-3)
    # Both are true to scale: first the registration's error, and then the hand's.
    by_registration, by_hand = (
        role.find(scene).GetPolyData()
        for role in (Role.ERRORS_BY_REGISTRATION, Role.ERRORS_BY_HAND)
    )
    for errors, line in zip(found.trajectories, analysis[1], strict=True):
        target, shown = line.planned[1], line.shown[1]
        for data, place in (
            (by_registration, target),
            (by_registration, shown),
            (by_hand, shown),
            (by_hand, errors.tip_ras),
        ):
            points = vtk_to_numpy(data.GetPoints().GetData())
            assert np.linalg.norm(points - place, axis=1).min() < 0.3


def test_everything_is_still_there_in_a_saved_and_reopened_scene(
    headless_scene, analysis, tmp_path
):
    showProcedureErrors(headless_scene.scene, *analysis)
    headless_scene.save(tmp_path / "procedure.mrb")
    load_bundle(headless_scene, tmp_path / "procedure.mrb")
    check(headless_scene.scene, analysis[0])
    assert Role.ERRORS_BY_HAND.find(headless_scene.scene).GetPolyData() is not None
    # When it is shown again, nothing is duplicated, and another plan replaces it.
    showProcedureErrors(headless_scene.scene, *analysis)
    check(headless_scene.scene, analysis[0])
    other = made_up_procedure(trajectory("Only", (0.0, 0.0, 90.0), (0.0, 5.0, 10.0)))
    for plan, names in ((other, ["Only"]), (None, [])):
        showPlannedLines(headless_scene.scene, plan)
        shown = [node.GetName() for role in ROLES for node in role.all(headless_scene.scene)]
        assert shown == names
        assert Role.PROCEDURE_ERRORS.find(headless_scene.scene) is None
