"""How drill and instrument were fed, from the samples of a journal."""

import pytest

from rastrainer_simulator.record.trial_records import FeedRecording


def phase(stage, trajectory=0):
    return {"kind": "phase", "procedure": {"name": "dbs", "stage": stage, "trajectory": trajectory}}


def samples(depths_mm, start_s=0.0):
    return [
        {"kind": "sample", "simTimeS": start_s + 0.02 * number, "feedMm": depth}
        for number, depth in enumerate(depths_mm)
    ]


def metrics_of(*entries, trajectory=0):
    recording = FeedRecording()
    for entry in entries:
        recording.add(entry)
    return recording.metrics(trajectory)


def test_path_time_and_top_speed_are_computed_from_the_samples():
    found = metrics_of(phase("drilling"), *samples([0.0, 0.1, 0.15, 0.15, 0.25]))
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
def test_backward_motion_counts_as_a_reversal_only_beyond_tremor(depths_mm, reversals):
    assert metrics_of(phase("inserting"), *samples(depths_mm))["instrument_reversals"] == reversals


def test_tools_and_trajectories_are_kept_apart_and_a_tool_change_adds_no_path():
    entries = (
        phase("drilling"),
        *samples([0.0, 0.1]),
        phase("inserting"),
        *samples([0.0, 0.2], 1.0),
        phase("drilling", 1),
        *samples([0.0, 0.3], 2.0),
    )
    first, second = metrics_of(*entries), metrics_of(*entries, trajectory=1)
    assert (first["drill_path_mm"], first["instrument_path_mm"]) == pytest.approx((0.1, 0.2))
    assert (second["drill_path_mm"], second["instrument_path_mm"]) == pytest.approx((0.3, 0.0))


@pytest.mark.parametrize("between", [phase("drilling"), {"kind": "continued"}])
def test_a_pause_or_a_new_hole_adds_no_path_and_no_reversal(between):
    found = metrics_of(phase("drilling"), *samples([0.0, 1.0]), between, *samples([0.0, 0.5], 9.0))
    assert found["drill_path_mm"] == pytest.approx(1.5)
    assert found["drill_reversals"] == 0
