"""The score of a procedure has the documented properties."""

import json
import math
from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.procedure.errors import analyze_procedure
from rastrainer.procedure.plan import MAX_SAFETY_MM
from rastrainer.trial import procedure_outcome as scoring
from Testing.domain.procedure.made_up_procedure import made_up_meshes, made_up_procedure, trajectory
from Testing.domain.procedure.procedure_records import recorded

references = st.sampled_from([120.0, 300.0, 900.0])
LIMITS = {
    "worst_target_mm": scoring.TARGET_LIMIT_MM,
    "worst_entry_mm": scoring.ENTRY_LIMIT_MM,
    "worst_angle_deg": scoring.ANGLE_LIMIT_DEG,
    "plunge_mm": scoring.PLUNGE_LIMIT_MM,
    "hits": 0,
    "missed_bone": 0,
}
SCORED = ("duration_s", "target_mm", "entry_mm", "angle_deg", "plunge_mm", "intrusion_mm")
MESHES, DOWN = made_up_meshes(), trajectory()


@st.composite
def procedures(draw, target=1000.0, entry=1000.0, angle=180.0, plunge=200.0, counts=3):
    """Any procedure within limits; a root mean square is at most the largest value."""
    worst = [draw(st.floats(0.0, limit)) for limit in (target, entry, angle)]
    target_mm, entry_mm, angle_deg = (draw(st.floats(0.0, value)) for value in worst)
    return scoring.ProcedureMeasures(
        duration_s=draw(st.floats(1.0, 86_400.0)),
        target_mm=target_mm,
        worst_target_mm=worst[0],
        entry_mm=entry_mm,
        worst_entry_mm=worst[1],
        angle_deg=angle_deg,
        worst_angle_deg=worst[2],
        plunge_mm=draw(st.floats(0.0, plunge)),
        intrusion_mm=draw(st.floats(0.0, MAX_SAFETY_MM)),
        hits=draw(st.integers(0, counts)),
        missed_bone=draw(st.integers(0, counts)),
    )


acceptable = procedures(
    scoring.TARGET_LIMIT_MM,
    scoring.ENTRY_LIMIT_MM,
    scoring.ANGLE_LIMIT_DEG,
    scoring.PLUNGE_LIMIT_MM,
    counts=0,
)


def score(measures, reference):
    return scoring.score_procedure(measures, reference).score


@settings(max_examples=40)
@given(st.sampled_from(SCORED), procedures(), st.floats(1e-3, 1e3), references)
def test_faster_more_accurate_and_gentler_are_each_strictly_better(
    measure, measures, step, reference
):
    worse = replace(measures, **{measure: getattr(measures, measure) + step})
    assert score(measures, reference) > score(worse, reference)


@settings(max_examples=40)
@given(st.sampled_from([*LIMITS]), procedures(), acceptable, st.floats(0.0, 100.0), references)
def test_exceeding_a_limit_cannot_be_compensated(measure, measures, other, excess, reference):
    limit = LIMITS[measure]
    beyond = 1 + int(excess) if limit == 0 else math.nextafter(limit, math.inf) + excess
    worse = scoring.score_procedure(replace(measures, **{measure: beyond}), reference)
    assert not worse.acceptable
    best = scoring.score_procedure(other, reference)
    assert best.acceptable
    assert worse.score < best.score


@settings(max_examples=40)
@given(procedures(), references)
def test_a_score_survives_json_with_its_version(measures, reference):
    first = scoring.score_procedure(measures, reference)
    assert 0.0 < first.score <= 100.0
    again = record_from_json(scoring.ProcedureScore, json.loads(json.dumps(record_to_json(first))))
    assert again == first
    assert again.version == scoring.PROCEDURE_SCORE_VERSION
    assert score(again.measures, again.reference_s) == first.score


PERFECT = scoring.ProcedureMeasures(100.0, *([0.0] * 8), 0, 0)


def test_scores_of_version_1_do_not_change():
    assert scoring.PROCEDURE_SCORE_VERSION == "procedure-1"
    usual = replace(
        PERFECT,
        target_mm=2.0,
        worst_target_mm=2.0,
        entry_mm=1.5,
        worst_entry_mm=1.5,
        angle_deg=2.0,
        worst_angle_deg=2.0,
        plunge_mm=2.0,
        intrusion_mm=1.5,
    )
    assert score(usual, 100.0) == pytest.approx(100 * (0.52 * 0.5**5) ** (1 / 6))
    assert score(PERFECT, 100.0) == pytest.approx(100 * 0.52 ** (1 / 6))
    worst = 0.04 / (1 + 2.25) / 5 / 7.25 / 7.25 / (1 + (MAX_SAFETY_MM / 1.5) ** 2)
    hit = replace(PERFECT, intrusion_mm=1.5, hits=1)
    assert score(hit, 100.0) == pytest.approx(100 * (0.52 * 0.5 * worst) ** (1 / 6))


@pytest.mark.parametrize("value", [-1.0, math.nan, math.inf])
def test_a_measure_that_is_not_a_valid_number_is_refused(value):
    for field in fields(scoring.ProcedureMeasures):
        with pytest.raises(InputError, match=f"{field.name} must be a number from 0"):
            scoring.score_procedure(replace(PERFECT, **{field.name: value}), 100.0)


def measured(record, procedure):
    analysis = analyze_procedure(record, procedure, MESHES, np.eye(4))
    return scoring.ProcedureMeasures.of(analysis, procedure)


def carried_out(off, lines=(DOWN,), **changes):
    """The score of steady hands whose registration is off by a shift (3,), mm."""
    procedure = made_up_procedure(*lines)
    record = recorded(
        procedure, transforms.rigid(np.eye(3), np.array(off, dtype=float)), drill=14.5
    )
    record = replace(record, **changes)
    return scoring.score_procedure(
        measured(record, procedure), scoring.reference_duration_s(130.0, procedure)
    )


def test_a_good_procedure_is_acceptable():
    found = carried_out((0.5, 0.0, 0.0))
    assert found.acceptable
    assert found.score > 80


def test_a_hit_is_never_acceptable_however_fast_and_accurate():
    through = trajectory(entry=(30, 0, 84.85), target=(30, 0, -20))
    found = carried_out((0.0, 0.0, 0.0), lines=(through,), duration_s=1.0)
    assert found.measures.hits == 1
    assert found.measures.worst_target_mm == pytest.approx(0.0, abs=1e-9)
    assert not found.acceptable
    slow_and_poor = carried_out((2.9, 0.0, 0.0), duration_s=86_400.0)
    assert slow_and_poor.acceptable
    assert found.score < slow_and_poor.score


def test_the_worst_of_several_instruments_decides_whether_it_is_acceptable():
    lines = [trajectory(f"{n}", (n, 0, 89.9), (n, 0, 20)) for n in range(0, -20, -4)]
    procedure = made_up_procedure(*lines)
    record = recorded(procedure, np.eye(4), drill=14.5)
    first, *others = record.instruments
    deeper = replace(first, instrument_depth_mm=first.instrument_depth_mm + 3.5)
    record = replace(record, instruments=(deeper, *others))
    measures = measured(record, procedure)
    assert measures.target_mm < scoring.TARGET_LIMIT_MM < measures.worst_target_mm
    assert not scoring.score_procedure(measures, 600.0).acceptable


def test_what_a_trainee_sees_plays_no_part_in_the_score():
    """Checkpoints, FRE and the number of attempts change nothing."""
    procedure = made_up_procedure()
    record = recorded(procedure, np.eye(4))
    accepted = record.attempts[-1]
    seen = replace(
        accepted,
        registration=replace(accepted.registration, fre_mm=9.0, expected_tre_mm=9.0),
        checkpoints=(),
    )
    scores = {
        score(measured(each, procedure), 300.0)
        for each in (record, replace(record, attempts=(seen,)))
    }
    assert len(scores) == 1
