"""Each error of a planned procedure is reported in one sentence that names its parts."""

import numpy as np
import pytest

from rastrainer.head.mesh import HeadMesh
from rastrainer.procedure import checks
from rastrainer.procedure.plan import Checkpoint, ProcedureMeshes
from Testing.domain.procedure.made_up_procedure import (
    VESSEL_MM,
    made_up_meshes,
    made_up_procedure,
    shell,
    trajectory,
)
from Testing.domain.scenario.made_up_scenario import ball_head

HEAD = ball_head()


def wrong(*trajectories, meshes=None, **changes):
    procedure = made_up_procedure(*trajectories, **changes)
    return checks.check_procedure(procedure, HEAD, meshes or made_up_meshes())[1]


def test_a_good_plan_has_no_errors():
    assert wrong() == []


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        (trajectory(target=(0, 0, 120)), "has its target 30 mm outside of the head."),
        (
            trajectory(entry=(0, 0, 110)),
            "enters 20 mm above the skin; its entry must be within 10 mm of the skin.",
        ),
        (
            trajectory(entry=(0, 0, 75)),
            "enters 15 mm below the skin, within the head; its entry must be within 10 mm of the "
            "skin.",
        ),
        (trajectory(target=(0, 0, -70.0)), "is 160 mm long; it may be 150 mm."),
        (
            trajectory(entry=(0, 55, 71), target=(0, -40, 70)),
            "meets the skull at 58° to its normal; it may be 40°.",
        ),
        (trajectory(entry=(30, 0, 84.85), target=(30, 0, -20)), "goes through Vessel."),
        (
            trajectory(entry=(22.5, 0, 87.1), target=(22.5, 0, -20)),
            "comes within 1.5 mm of Vessel; its safety distance is 3 mm.",
        ),
    ],
    ids=["target", "above", "below", "long", "angle", "hit", "near"],
)
def test_an_unusable_line_is_reported_in_one_sentence(line, sentence):
    assert wrong(line) == [f"Two leads: Left {sentence}"]


def test_a_line_that_leaves_the_head_is_reported_with_the_distance_before_its_target():
    left, right = (ball_head(40.0).vertices + np.array([x, 0.0, 0.0]) for x in (-50.0, 50.0))
    triangles = ball_head(40.0).triangles
    two = HeadMesh(
        np.concatenate([left, right]), np.concatenate([triangles, triangles + len(left)])
    )
    procedure = made_up_procedure(trajectory(entry=(-90, 0, 0), target=(30, 0, 0)))
    assert checks.check_procedure(procedure, two, made_up_meshes())[1] == [
        "Two leads: Left leaves the head 40 mm before its target; it must stay within it."
    ]


def test_a_line_that_misses_the_skull_has_nothing_to_drill():
    above = HeadMesh(shell().vertices * [1.0, 1.0, 0.1] - [0.0, 0.0, 60.0], shell().triangles)
    meshes = ProcedureMeshes(above, {})
    assert wrong(trajectory(), meshes=meshes) == [
        "Two leads: Left does not go through the skull; drilling needs bone."
    ]


def test_a_skull_without_an_inner_table_is_reported_as_such():
    meshes = ProcedureMeshes(ball_head(83.0), {})
    (sentence,) = wrong(trajectory(), meshes=meshes)
    assert "Left meets a skull without an inner table; make the skull again" in sentence


def test_instruments_that_come_too_close_to_each_other_are_both_named():
    one = trajectory("One", (0, 0, 90), (0, 0, 20))
    other = trajectory("Other", (40, 0, 80.6), (2.5, 0, 20))
    assert wrong(one, other) == [
        "Two leads: One and Other come within 0.5 mm of each other; they must stay 1 mm apart."
    ]
    crossing = trajectory("Other", (40, 0, 80.6), (-20, 0, 20))
    assert wrong(one, crossing) == [
        "Two leads: One and Other come within 0.0 mm of each other; they must stay 1 mm apart."
    ]


def test_a_checkpoint_off_the_skin_is_named():
    points = (Checkpoint("Vertex", np.array([0.0, 0.0, 87.0])),)
    assert wrong(checkpoints=points) == [
        "Two leads: the checkpoint Vertex is 3.0 mm off the skin; it must be within 1 mm."
    ]


def test_the_distance_to_a_structure_is_measured_between_the_surfaces():
    line = trajectory(entry=(10, 0, 89.4), target=(10, 0, -20), diameter=3.0)
    distances = checks.distances_to_no_go(line, made_up_meshes())
    assert distances == pytest.approx({"Vessel": 20.0 - VESSEL_MM - 1.5}, abs=0.05)


@pytest.mark.parametrize("height", [97.0, 90.0, 80.0])
def test_planned_bone_is_measured_from_the_entry_wherever_it_lies(height):
    bone = checks.planned_bone(trajectory(entry=(0, 0, height)), shell())
    assert bone == pytest.approx((height - 83.0, height - 76.0))


def test_a_line_is_measured_by_length_angle_and_its_nearest_structure_and_line():
    one = trajectory("One", (0, 0, 90), (0, 0, 20), diameter=2.0)
    other = trajectory("Other", (40, 0, 80.6), (2.5, 0, 20), diameter=3.0)
    outside = trajectory("Outside", (0, 0, 200), (0, 0, 150))
    procedure = made_up_procedure(one, other, outside)
    measured = {each.name: each for each in checks.measure_lines(procedure, made_up_meshes())}
    assert measured["One"].length_mm == pytest.approx(70.0)
    assert measured["One"].skull_angle_deg == pytest.approx(0.0, abs=3.0)
    assert measured["One"].nearest_no_go == "Vessel"
    assert measured["One"].nearest_line == "Other"
    assert measured["One"].nearest_line_mm == pytest.approx(2.5 - 2.5, abs=0.1)
    assert measured["Outside"].skull_angle_deg is None
    (alone,) = checks.measure_lines(made_up_procedure(one), made_up_meshes())
    assert (alone.nearest_line, alone.nearest_line_mm) == ("", None)
