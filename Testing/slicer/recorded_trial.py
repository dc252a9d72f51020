"""A journal of a made-up trial of a few seconds, for the tests of replays."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer import transforms
from rastrainer.journal.entries import TracePoint
from rastrainer.json_records import record_from_json
from rastrainer.scenario.points import LABELS
from rastrainer.scenario.scenario import Scenario, load_scenario
from rastrainer.slicer.scene.nodes import Role, setPoints
from rastrainer.slicer.scene.robot_description import toolPoses
from rastrainer.trial.analysis import RevealedTruth, TrialAnalysis, analyze_trial
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import SAFETY_METRICS
from rastrainer_simulator.assets import asset_path
from Testing.journal_lines import at, header, journal_bytes, sample, touch
from Testing.slicer.host.host import Host

TICK_S = 0.004
START_S = 100.0
URDF = asset_path("robots", "iiwa7") / "iiwa7.urdf"


def write_recorded_trial(
    folder: Path,
    trial_id: str,
    seconds: float = 3.0,
    trainee: str = "T-001",
    touch_every_s: int = 1,
    traced: int = 0,
) -> np.ndarray:
    """Write the journal of a trial with a touch each second, or less often.

    Each of the first `traced` samples without a touch adds a trace point.

    Returns:
        Its tips (n, 3) float, mm.
    """
    times = np.arange(5, round(seconds / TICK_S) + 1, 5) * TICK_S
    q = np.array([0.1, 0.5, -0.2, -1.4, 0.3, 0.9, 0.0]) + 0.05 * np.sin(times)[:, None]
    tips = toolPoses(URDF, q)[:, :3, 3]
    lines = [at(START_S + TICK_S, header(TICK_S, trial_id=trial_id, trainee=trainee))]
    for number, (time, posture, tip) in enumerate(zip(times, q, tips.tolist(), strict=True)):
        time_s, tick, place = START_S + time, 5 * number, tuple(tip)
        posed = sample(place, q=tuple(posture.tolist()), clearance_mm=30.0 - 5.0 * time)
        lines.append(at(time_s, posed, tick))
        if round(time / TICK_S) % (250 * touch_every_s) == 0:
            count = round(time) // touch_every_s
            lines.append(at(time_s + TICK_S, touch(str(count), place, count), tick))
        elif number < traced:
            lines.append(at(time_s, TracePoint(position_mm=place, kept=number + 1), tick))
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"20260302T090000Z_{trial_id}.journal").write_bytes(journal_bytes(lines))
    return tips


def scored_analysis(
    record: Mapping[str, Any], scenario: Scenario, seed: int = 1, true_tre_mm: float = 0.3
) -> TrialAnalysis:
    """Return the analysis of a gentle trial with the seed's pose of the head.

    The record's other motion metrics are unchanged.
    """
    motion = dict.fromkeys(SAFETY_METRICS, 0.0) | dict(record.get("motion", {}))
    pose = scenario.perturbed_head_to_world(seed)
    truth = RevealedTruth(tuple(pose.ravel().tolist()), true_tre_mm)
    read = record_from_json(TrialRecord, {**record, "motion": motion})
    return analyze_trial(read, scenario).scored(scenario, truth)


COLIN27 = load_scenario(asset_path("scenarios", "colin27"))


def touches_on_colin(seed: int = 3, task: str = "task-1", noise_mm: float = 0.6) -> np.ndarray:
    """Return touches of a task on Colin27, (15, 3) float, World, mm."""
    noise = np.random.default_rng(seed).normal(0.0, noise_mm, (15, 3))
    head_to_world = COLIN27.perturbed_head_to_world(seed)
    return transforms.apply(head_to_world, COLIN27.task(task).fiducials + noise)


def store_trial_on_colin(host: Host, record: dict[str, Any], seed: int) -> np.ndarray:
    """Store a scored trial on Colin27 over the open module's connection to the study.

    The module could show a change over another connection at any time. The points of the record
    become touches drawn by `seed`, which are returned: (15, 3) float, World, mm.
    """
    touched = touches_on_colin(seed, record["task"])
    for point, position in zip(record["points"], touched.tolist(), strict=True):
        point["positionMm"] = position
    analysis = scored_analysis({**record, "scenario": "colin27"}, COLIN27)
    host.widget.logic.session.trainees.study.add_trial(
        {**record, "scenario": "colin27"},
        analysis.fits.values(),
        analysis.target_errors,
        analysis.score,
    )
    return touched


def put_touches(host: Host, points: np.ndarray) -> None:
    """Put touches, World, mm, into the scene, and wait until the module has registered them."""
    setPoints(Role.CAPTURED_POINTS.make(host.scene), LABELS[: len(points)], points)
    count = len(points) if len(points) > 2 else 0
    table = host.find("residualsTable")
    host.wait_until(lambda: table.rowCount == count, "the touches are registered")
    host.finish_work()
