"""The errors of a procedure against the truth, and their causes; unusable records of one."""

import json
from dataclasses import replace

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.procedure.errors import analyze_procedure
from rastrainer.procedure.record import ProcedureRecord
from rastrainer.trial.procedure_outcome import ProcedureMeasures
from Testing.domain.procedure.made_up_procedure import (
    VESSEL_MM,
    made_up_meshes,
    made_up_procedure,
    trajectory,
)
from Testing.domain.procedure.procedure_records import recorded, rotation

MESHES = made_up_meshes()
DOWN = trajectory()
TRUTH = transforms.rigid(rotation(np.random.default_rng(5), 180.0), np.array([400.0, -20.0, 250.0]))


def shifted(x=0.0, y=0.0, z=0.0):
    """Where a wrong registration puts the head: shifted along R, A and S, mm."""
    return TRUTH @ transforms.rigid(np.eye(3), np.array([x, y, z]))


def analyzed(shown=TRUTH, lines=(DOWN,), **changes):
    """The errors of steady hands by a registration, after changes of each instrument."""
    procedure = made_up_procedure(*lines)
    record = recorded(procedure, shown)
    if changes:
        record = replace(
            record, instruments=tuple(replace(one, **changes) for one in record.instruments)
        )
    return analyze_procedure(record, procedure, MESHES, TRUTH)


def depths(errors):
    return (
        errors.depth_error_mm,
        errors.depth_error_by_registration_mm,
        errors.depth_error_by_hand_mm,
    )


def whole(error):
    return np.add(error.by_registration_ras, error.by_hand_ras)


def placed(shown=TRUTH):
    """The instrument of steady hands by a registration."""
    return recorded(made_up_procedure(DOWN), shown).instruments[0]


def only(analysis):
    (errors,) = analysis.trajectories
    return errors


def test_a_sideways_registration_error_is_attributed_to_the_registration_and_not_to_the_hand():
    errors = only(analyzed(shifted(x=2.0)))
    assert errors.target_point_error.by_registration_ras == pytest.approx([2.0, 0.0, 0.0], abs=1e-9)
    assert errors.target_point_error.by_hand_ras == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    assert (errors.entry_point_error.mm, errors.radial_error.mm) == pytest.approx((2.0, 2.0))
    assert depths(errors) == pytest.approx((0.0, 0.0, 0.0), abs=1e-9)


def test_an_instrument_not_inserted_far_enough_has_a_negative_depth_error():
    deep = placed().instrument_depth_mm
    errors = only(analyzed(instrument_depth_mm=deep - 3.0))
    assert depths(errors) == pytest.approx((-3.0, 0.0, -3.0), abs=1e-9)
    assert errors.target_point_error.mm == pytest.approx(3.0)
    assert errors.radial_error.mm == pytest.approx(0.0, abs=1e-9)


def test_a_rotated_guide_has_an_angular_deviation_caused_by_the_hand():
    exact = placed()
    turn = np.radians(2.0)
    turned = TRUTH[:3, :3] @ np.array([np.sin(turn), 0.0, -np.cos(turn)])
    errors = only(analyzed(guide_direction=tuple(turned.tolist())))
    assert errors.angular_deviation_deg == pytest.approx(2.0)
    assert errors.angular_deviation_by_hand_deg == pytest.approx(2.0)
    assert errors.angular_deviation_by_registration_deg == pytest.approx(0.0, abs=1e-9)
    assert errors.entry_point_error.mm == pytest.approx(30.0 * np.sin(turn))
    depth = exact.instrument_depth_mm
    assert errors.radial_error.mm == pytest.approx(depth * np.sin(turn))
    assert errors.depth_error_mm == pytest.approx(-depth * (1 - np.cos(turn)))


@pytest.mark.parametrize("seed", range(4))
def test_the_shares_of_registration_and_hand_add_up_exactly(seed):
    random = np.random.default_rng(seed)
    off = transforms.rigid(rotation(random, 4.0), random.normal(0.0, 2.0, 3))
    tip = np.array(placed(TRUTH @ off).guide_tip_mm)
    errors = only(
        analyzed(
            TRUTH @ off,
            guide_tip_mm=tuple(tip + random.normal(0.0, 2.0, 3)),
            instrument_depth_mm=100.0 + random.normal(),
        )
    )
    there = transforms.apply(transforms.inverse(TRUTH), tip)
    assert not np.allclose(errors.guide_tip_ras, there)
    reached = errors.tip_ras - DOWN.target_ras
    assert whole(errors.target_point_error) == pytest.approx(reached, abs=1e-9)
    shown = transforms.apply(off, DOWN.target_ras)
    assert errors.target_point_error.by_registration_ras == pytest.approx(
        shown - DOWN.target_ras, abs=1e-9
    )
    depth, registration, hand = depths(errors)
    assert depth == pytest.approx(registration + hand)
    assert errors.target_point_error.mm == pytest.approx(np.hypot(errors.radial_error.mm, depth))
    radial = errors.radial_error
    assert radial.mm == pytest.approx(np.linalg.norm(whole(radial)))
    parts = errors.angular_deviation_by_registration_deg, errors.angular_deviation_by_hand_deg
    assert abs(parts[0] - parts[1]) - 1e-9 <= errors.angular_deviation_deg <= sum(parts) + 1e-9


def test_plunging_is_measured_from_the_inner_table_of_the_true_skull():
    assert only(analyzed(drill_depth_mm=43.9)).plunge_mm == 0.0
    assert only(analyzed(drill_depth_mm=46.5)).plunge_mm == pytest.approx(2.5)
    shallower = only(analyzed(shifted(z=-2.0), drill_depth_mm=46.5))
    assert shallower.plunge_mm == pytest.approx(4.5)


def test_an_axis_that_misses_the_skull_has_no_plunge_and_is_named():
    beside = tuple(transforms.apply(TRUTH, np.array([0.0, 95.0, 120.0])))
    analysis = analyzed(guide_tip_mm=beside)
    assert only(analysis).plunge_mm is None
    assert analysis.missed_bone == ("Left",)


@pytest.mark.parametrize(
    ("x", "kept", "hits"),
    [(0.0, 24.0, ()), (-22.0, 2.0, ()), (-24.5, -0.5, ("Vessel",)), (-30.0, -1.0, ("Vessel",))],
)
def test_the_distance_kept_from_a_structure_is_that_of_the_true_instrument(x, kept, hits):
    """The plan passes the vessel (at 30 mm) in the midline; the registration moves it there."""
    line = trajectory(target=(0, 0, -20))
    analysis = analyzed(shifted(x=-x), lines=(line,))
    assert only(analysis).kept_mm["Vessel"] == pytest.approx(kept, abs=0.1)
    assert [name for _trajectory, name in analysis.hits] == list(hits)
    measures = ProcedureMeasures.of(analysis, made_up_procedure(line))
    assert measures.intrusion_mm == pytest.approx(max(0.0, 3.0 - kept), abs=0.1)
    assert VESSEL_MM == 5.0


def test_a_drill_that_goes_deeper_than_the_instrument_counts_for_the_distance():
    line = trajectory(entry=(30, 0, 84.85), target=(30, 0, 20))
    assert only(analyzed(lines=(line,))).kept_mm["Vessel"] == pytest.approx(14.0, abs=0.1)
    plunged = analyzed(lines=(line,), drill_depth_mm=30.0 + 82.0)
    assert plunged.hits == (("Left", "Vessel"),)


def test_the_record_of_another_plan_is_refused():
    record = recorded(made_up_procedure(DOWN), TRUTH)
    moved = made_up_procedure(trajectory(target=(0, 0, 21)))
    for procedure in (moved, made_up_procedure(), made_up_procedure(DOWN, name="other")):
        with pytest.raises(InputError, match="of another plan than the procedure"):
            analyze_procedure(record, procedure, MESHES, TRUTH)


MIRROR = [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]


@pytest.mark.parametrize(
    ("part", "changes", "sentence"),
    [
        ("attempts", {"registration": None}, "must end with an accepted registration"),
        (
            "attempts",
            {"registration": {"matrix": MIRROR, "freMm": 0.8, "expectedTreMm": 0.6}},
            "matrix must be a rigid transform",
        ),
        ("instruments", {"guideDirection": [0, 0, 0.9]}, "guideDirection must be a unit vector"),
    ],
    ids=["not registered", "mirrored", "no unit vector"],
)
def test_a_record_that_cannot_be_one_is_refused(part, changes, sentence):
    record = recorded(made_up_procedure(), np.eye(4))
    value = json.loads(json.dumps(record_to_json(record)))
    assert record_from_json(ProcedureRecord, value) == record
    value[part][-1] |= changes
    with pytest.raises(InputError, match=sentence):
        record_from_json(ProcedureRecord, value)
