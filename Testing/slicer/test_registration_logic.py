"""The registration that is shown follows its lists, and every change can be undone."""

import threading

import numpy as np
import pytest
import slicer

from rastrainer import transforms
from rastrainer.head.mesh import nearest_on_mesh
from rastrainer.registration.fits import AFFINE, KINDS, RIGID
from rastrainer.registration.localization_error import error_along_surface
from rastrainer.registration.registration import register, register_all_kinds
from rastrainer.registration.target_error import expected_tre, target_error
from rastrainer.scenario.points import LABELS
from rastrainer.sections.registration_logic import RegistrationLogic
from rastrainer.slicer.scene.error_colors import TRE_SCALARS
from rastrainer.slicer.scene.nodes import Role, setPoints, worldPoints
from rastrainer.slicer.scene.scenario_nodes import showTask
from Testing.slicer.shown_scenario import show_whole
from Testing.slicer.work_at_once import WorkAtOnce, in_turns

LEGEND = "vtkMRMLColorLegendDisplayNode"


class Table:
    """The scene of a played trial, and the logic that registers it."""

    def __init__(self, scene, scenario):
        self.scene, self.scenario = scene, scenario
        show_whole(scene, scenario)
        self.fixed = showTask(scene, scenario, "task-1")
        noise = np.random.default_rng(3).normal(0.0, 0.6, (15, 3))
        self.touched_on_mri = scenario.task("task-1").fiducials + noise
        self.touched = transforms.apply(scenario.perturbed_head_to_world(3), self.touched_on_mri)
        self.logic = RegistrationLogic(scene, WorkAtOnce())
        self.changes = []
        self.logic.changed.connect(lambda: self.changes.append(self.logic.comparison))

    def touch(self, points=None, labels=LABELS):
        points = self.touched if points is None else points
        setPoints(Role.CAPTURED_POINTS.make(self.scene), labels[: len(points)], points)
        self.logic.process()

    def node(self, role):
        return role.find(self.scene)


@pytest.fixture
def table(scene, scenario):
    return Table(scene, scenario)


def test_three_fits_are_shown_side_by_side_with_the_expected_error(table):
    table.touch()
    fits = table.logic.comparison.fits
    assert list(fits) == list(KINDS)
    for kind, fit in fits.items():
        again = register(table.touched, table.scenario.task("task-1").fiducials, kind, LABELS)
        assert fit.fre_mm == pytest.approx(again.fre_mm, abs=1e-5)
        normals = again.fixed_mm / np.linalg.norm(again.fixed_mm, axis=1, keepdims=True)
        localization = error_along_surface(again, normals)
        error = target_error(again, table.scenario.target.position_ras, localization)
        assert table.logic.comparison.errors[kind].expected_mm == pytest.approx(
            error.expected_mm, rel=0.02
        )
    assert table.node(Role.FITS).GetNumberOfRows() == 3
    assert table.node(Role.RESIDUALS).GetNumberOfRows() == 15


def test_touches_are_registered_during_the_trial_from_the_third_on(table):
    table.touch(table.touched[:2])
    assert table.logic.comparison is None
    assert "at least 3" in table.logic.problem
    table.touch(table.touched[:5])
    assert table.logic.comparison.pairs.missing == LABELS[5:]
    assert len(table.logic.comparison.shown.labels) == 5
    assert AFFINE in table.logic.comparison.fits


def test_nothing_is_recomputed_while_nothing_changes(table):
    for touches in (2, 15):
        table.touch(table.touched[:touches])
        count = len(table.changes)
        for _ in range(5):
            table.logic.process()
        assert len(table.changes) == count


def test_a_touch_that_is_deselected_in_slicer_is_left_out_until_it_is_selected(table):
    bad = table.touched.copy()
    bad[6] += [9.0, -6.0, 5.0]
    table.touch(bad)
    before, touches = table.logic.comparison.shown.fre_mm, Role.CAPTURED_POINTS.make(table.scene)
    touches.SetNthControlPointSelected(6, False)
    table.logic.process()
    pairs = table.logic.comparison.pairs
    assert (pairs.excluded, pairs.missing, len(pairs.labels)) == (("7",), (), 14)
    assert table.logic.comparison.shown.fre_mm < 0.5 * before
    table.fixed.SetNthControlPointSelected(0, False)
    table.logic.process()
    assert {*table.logic.comparison.pairs.excluded} == {"1", "7"}
    for node in (touches, table.fixed):
        for row in range(15):
            node.SetNthControlPointSelected(row, True)
    table.logic.process()
    assert table.logic.comparison.shown.fre_mm == before


def test_a_stated_localization_error_weights_only_the_rigid_fit_and_can_be_undone(table):
    table.touch()
    plain = table.logic.comparison
    table.logic.change(table.logic.choices.localized("4", 5.0))
    weighted = table.logic.comparison
    fixed = table.scenario.task("task-1").fiducials
    weights = np.array([0.04 if label == "4" else 1.0 for label in LABELS])
    again = register(table.touched, fixed, "rigid", LABELS, weights)
    np.testing.assert_allclose(weighted.fits["rigid"].matrix, again.matrix, atol=1e-4)
    assert weighted.fits["affine"].fre_mm == plain.fits["affine"].fre_mm
    expected = target_error(again, table.scenario.target.position_ras)
    assert weighted.errors["rigid"].expected_mm == pytest.approx(expected.expected_mm, rel=1e-3)
    table.logic.change(table.logic.choices.without(LABELS[:3] + LABELS[4:13]))
    assert len(table.logic.comparison.fits["rigid"].weights) == 3
    table.logic.change(table.logic.choices.without((LABELS[13],)))
    assert table.logic.comparison is None
    for _ in range(3):
        table.logic.undo()
    assert table.logic.comparison.fits["rigid"].weights is None
    assert table.logic.comparison.fits["rigid"].fre_mm == plain.fits["rigid"].fre_mm


def test_another_trial_begins_without_the_changes_of_the_previous_one(table):
    table.touch()
    table.logic.change(table.logic.choices.without(("3",)))
    setPoints(Role.CAPTURED_POINTS.make(table.scene), (), np.zeros((0, 3)))
    table.logic.process()
    table.touch()
    assert table.logic.comparison.pairs.excluded == ()
    assert not table.logic.canUndo


def test_the_head_is_colored_by_the_expected_error_at_each_place_with_a_legend(table):
    table.scene.RegisterNodeClass(slicer.vtkMRMLColorLegendDisplayNode())
    table.touch()
    table.logic.setHeadColored(True)
    head = table.node(Role.HEAD_MODEL)
    values = slicer.util.arrayFromModelPointData(head, TRE_SCALARS)
    points = slicer.util.arrayFromModelPoints(head)
    there = table.logic.comparison.targetError(points[100])
    assert values[100] == pytest.approx(there.expected_mm)
    display = head.GetDisplayNode()
    assert display.GetScalarVisibility()
    low, high = display.GetScalarRange()
    assert low <= values.min() < values.max() <= high
    count = table.scene.GetNumberOfNodesByClass(LEGEND)
    legends = [table.scene.GetNthNodeByClass(n, LEGEND) for n in range(count)]
    titles = {legend.GetTitleText(): legend for legend in legends}
    assert set(titles) == {"Residual (mm)", "TRE (mm)"}
    table.logic.setHeadColored(False)
    assert not display.GetScalarVisibility()
    assert not titles["TRE (mm)"].GetVisibility()
    table.touch(table.touched[:2])
    assert not titles["Residual (mm)"].GetVisibility()
    assert table.node(Role.RESIDUAL_ARROWS).GetPolyData().GetNumberOfPoints() == 0


def test_points_off_the_head_have_an_isotropic_error(table):
    setPoints(table.fixed, LABELS, 0.5 * table.scenario.task("task-1").fiducials)
    table.touch(transforms.apply(table.scenario.head_to_world, 0.5 * table.touched_on_mri))
    shown, position = table.logic.comparison.shown, table.scenario.target.position_ras
    assert table.logic.comparison.targetError(position) == target_error(shown, position)


def test_other_lists_can_be_registered_and_deleted_nodes_do_not_matter(table):
    table.touch()
    mine = table.scene.AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", "Mine")
    moved = table.touched + np.array([10.0, 0.0, 0.0])
    setPoints(mine, LABELS, moved)
    table.logic.chooseLists(mine, table.fixed, None)
    table.logic.process()
    np.testing.assert_allclose(table.logic.comparison.shown.moving_mm, moved)
    table.scene.RemoveNode(mine)
    table.logic.process()
    np.testing.assert_allclose(table.logic.comparison.shown.moving_mm, table.touched, atol=1e-9)
    for name in ("WORLD_TO_HEAD", "RESIDUAL_ARROWS", "HEAD_MODEL", "TARGET", "FIXED_FIDUCIALS"):
        table.scene.RemoveNode(table.node(getattr(Role, name)))
        table.logic.process()
    assert table.logic.comparison is None
    assert table.logic.problem == "Choose the list of fixed points."


@pytest.fixture
def threads(monkeypatch):
    """Returns the threads in which fits and normals are computed, by function."""
    found = {}

    def watch(place, function):
        def watched(*arguments):
            found.setdefault(function.__name__, set()).add(threading.get_ident())
            return function(*arguments)

        monkeypatch.setattr(f"rastrainer.{place}.{function.__name__}", watched)

    watch("slicer.scene.registration_input", nearest_on_mesh)
    watch("sections.registration_logic", register_all_kinds)
    watch("sections.registration_logic", target_error)
    watch("sections.registration_logic", expected_tre)
    return found


def test_nothing_is_computed_in_the_main_thread_and_normals_before_points_are_touched(
    table, logic_in_turns, work, threads
):
    logic_in_turns.process()
    in_turns(work)
    assert threading.get_ident() not in threads.pop("nearest_on_mesh")
    logic_in_turns.setHeadColored(True)
    setPoints(Role.CAPTURED_POINTS.make(table.scene), LABELS, table.touched)
    logic_in_turns.process()
    in_turns(work)
    assert logic_in_turns.comparison is not None
    assert threads.keys() == {"register_all_kinds", "target_error", "expected_tre"}
    assert threading.get_ident() not in set.union(*threads.values())


@pytest.fixture
def logic_in_turns(table, work):
    """Logic with turns; the table's own has none."""
    return RegistrationLogic(table.scene, work)


def test_of_changes_that_follow_one_another_only_the_last_is_shown(table, logic_in_turns, work):
    shown = []
    logic_in_turns.changed.connect(lambda: shown.append(logic_in_turns.comparison.pairs.excluded))
    setPoints(Role.CAPTURED_POINTS.make(table.scene), LABELS, table.touched)
    logic_in_turns.process()
    work.process()
    logic_in_turns.change(logic_in_turns.choices.without(("4",)))
    logic_in_turns.change(logic_in_turns.choices.without(("5",)))
    in_turns(work)
    assert shown == [("4", "5")]


def test_a_list_that_changes_back_is_registered_again_even_after_another_registration(
    table, logic_in_turns, work
):
    logic = logic_in_turns
    setPoints(Role.CAPTURED_POINTS.make(table.scene), LABELS, table.touched)
    logic.process()
    in_turns(work)
    fixed = worldPoints(table.fixed)
    setPoints(table.fixed, (), np.empty((0, 3)))
    logic.chooseKind(RIGID)
    assert logic.comparison is None
    setPoints(table.fixed, LABELS, fixed)
    logic.process()
    in_turns(work)
    assert logic.comparison is not None
