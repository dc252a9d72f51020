"""How drill and instrument were fed, from the samples of a journal."""

import pytest

from rastrainer.journal.entries import REAL_TIME, Continued, ProcedureAt
from rastrainer.protocol import Phase
from rastrainer_simulator.record.trial_records import FeedRecording
from Testing import journal_lines
from Testing.journal_lines import at


def stage(phase, trajectory=0):
    return at(0.0, journal_lines.phase(phase, procedure=ProcedureAt("dbs", phase, trajectory)))


DRILLING, INSERTING = stage(Phase.DRILLING), stage(Phase.INSERTING)


def samples(depths_mm, start_s=0.0):
    return [
        at(start_s + 0.02 * number, journal_lines.sample(feed_mm=depth))
        for number, depth in enumerate(depths_mm)
    ]


def metrics_of(*entries, trajectory=0):
    recording = FeedRecording()
    for entry in entries:
        recording.add(entry)
    return recording.metrics(trajectory)


def test_path_time_and_top_speed_are_computed_from_the_samples():
    found = metrics_of(DRILLING, *samples([0.0, 0.1, 0.15, 0.15, 0.25]))
    assert found["drill_path_mm"] == pytest.approx(0.25)
    assert found["drill_moving_s"] == pytest.approx(0.06)
    assert found["drill_fastest_mm_s"] == pytest.approx(5.0)
    assert found["drill_reversals"] == 0
    assert found["instrument_path_mm"] == 0.0


@pytest.mark.parametrize(
    ("depths_mm", "reversals"),
    [
        ([0.0, 1.0, 0.97, 2.0], 0),
        ([0.0, 1.0, 0.9, 2.0], 2),
        ([0.0, 1.0, 0.97, 0.94, 0.91], 1),
        ([2.0, 1.0, 0.0], 0),
        ([0.0, 1.0, 0.0, 1.0, 0.0], 3),
    ],
)
def test_backward_motion_counts_as_a_reversal_only_beyond_jitter(depths_mm, reversals):
    assert metrics_of(INSERTING, *samples(depths_mm))["instrument_reversals"] == reversals


def test_tools_and_trajectories_are_kept_apart_and_a_tool_change_adds_no_path():
    entries = (
        DRILLING,
        *samples([0.0, 0.1]),
        INSERTING,
        *samples([0.0, 0.2], 1.0),
        stage(Phase.DRILLING, 1),
        *samples([0.0, 0.3], 2.0),
    )
    first, second = metrics_of(*entries), metrics_of(*entries, trajectory=1)
    assert (first["drill_path_mm"], first["instrument_path_mm"]) == pytest.approx((0.1, 0.2))
    assert (second["drill_path_mm"], second["instrument_path_mm"]) == pytest.approx((0.3, 0.0))


CONTINUED = at(
    2.0,
    Continued(
        since_s=1.0,
        session=REAL_TIME,
        camera="far",
        phase=Phase.PAUSED,
        kept=0,
        next_point=None,
        versions={},
    ),
)


@pytest.mark.parametrize("between", [DRILLING, CONTINUED])
def test_a_pause_or_a_new_hole_adds_no_path_and_no_reversal(between):
    found = metrics_of(DRILLING, *samples([0.0, 1.0]), between, *samples([0.0, 0.5], 9.0))
    assert found["drill_path_mm"] == pytest.approx(1.5)
    assert found["drill_reversals"] == 0
