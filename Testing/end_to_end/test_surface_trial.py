"""A trial by surface over OpenIGTLink: registered and scored alike by the simulator and by Slicer.

A stroke that a kill cuts off is in Testing/simulator/record/test_recorded_trace.py.
"""

from __future__ import annotations

import json
import time

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.files.point_files import read_markups
from rastrainer.head.mesh import outward_normals, read_head_mesh
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.json_records import record_from_json
from rastrainer.protocol import RegistrationMethod
from rastrainer.scenario.scenario import Scenario, load_scenario, method_of, task_by_method
from rastrainer.sections.trial_logic import TrialLogic
from rastrainer.study.database.study import Study
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import SCORE_VERSION
from rastrainer_simulator.export.trial_files import write_slicer_files
from rastrainer_simulator.record.trial_context import setup_of
from rastrainer_simulator.replay.resimulation import replay
from Testing.end_to_end.faulty_proxy import SlicerSide
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.end_to_end.test_trial_over_openigtlink import SPEED, Player
from Testing.end_to_end.window_process import wait_until
from Testing.simulator.landmarked import LANDMARKS, OVER_THE_FACE, on_skin, write_landmarked

pytestmark = pytest.mark.soak

SEED = 5
ABOVE_MM, LANDED_MM, PASSED_MM = 30.0, 0.6, 1.5
SINK_MM, GLIDE_MM = 0.3, 0.15
"""How far below the skin the tip is sent to land, and above it to glide: neither is pressing."""
LEANS = ((0.0, 0.0, -0.4), (0.0, 0.0, -0.8), (0.0, 0.0, 0.0), (0.0, 0.4, -0.4), (0.0, -0.4, -0.4))
"""Additions to the direction into the skin, tried one after the other."""
SPEED_MM_S = 60
TIMEOUT_S = 120


class TracingTrainee:
    """Plays a trial of a seed, by which it knows where the head is, as a person sees it."""

    def __init__(self, player: Player, scenario: Scenario, seed: int) -> None:
        self._player = player
        self._scenario, self._seed = scenario, seed
        self._head = read_head_mesh(scenario.head)
        self._to_world = scenario.perturbed_head_to_world(seed)
        self._lean = np.array(LEANS[0])

    def start(self, method: str) -> str:
        """Start a trial and touch its landmarks; return its ID."""
        started = self._player.do(
            "StartTask", task="task-1", trainee="anna", seed=self._seed, method=method
        )
        task = task_by_method(self._scenario, "task-1", method_of(method))
        for landmark in task.fiducials:
            self._land(landmark)
            self._player.do("Capture")
            self._lift(landmark)
        return started["trialId"]

    def trace(self, corners) -> None:
        """Draw a stroke over the skin."""
        places = on_skin(self._head, corners)
        self._land(places[0])
        self._player.do("Trace", on=True)
        for place in places[1:]:
            self._go(place, GLIDE_MM, SPEED_MM_S)
        self._player.do("Trace", on=False)
        self._lift(places[-1])

    def _state(self, is_wanted=bool) -> dict:
        """Wait for a state of the simulator and return it."""
        found = self._player.wait_for(
            "SimState", lambda m: is_wanted(json.loads(m.content.text)), TIMEOUT_S
        )
        return json.loads(found.content.text)

    def _land(self, place) -> None:
        """Lower the tip onto a place; if the tool meets the skin next to it, lean it again."""
        for lean in LEANS:
            self._lean = np.array(lean)
            self._go(place, ABOVE_MM, 400)
            goal = self._send(place, -SINK_MM, 300)
            self._state(
                lambda state, goal=goal: (
                    self._off(goal) < LANDED_MM or state["proximity"] == "contact"
                )
            )
            if self._off(goal) < LANDED_MM:
                return
            self._lift(place)
        raise AssertionError(f"the tip never landed at {place}")

    def _lift(self, place) -> None:
        self._go(place, ABOVE_MM, 400)

    def _go(self, place, above_mm: float, speed_mm_s: float) -> None:
        """Move the tip above a place of the head, RAS, until it is nearly there."""
        goal = self._send(place, above_mm, speed_mm_s)
        self._player.wait_for("ToolTipToWorld", lambda _tip: self._off(goal) < PASSED_MM, TIMEOUT_S)

    def _send(self, place, above_mm: float, speed_mm_s: float) -> np.ndarray:
        """Send the tip above a place of the head, or below it; return where to, World, mm."""
        normal = outward_normals(self._head, [place])[0]
        goal = transforms.apply(self._to_world, place + above_mm * normal)
        direction = self._lean - self._to_world[:3, :3] @ normal
        self._player.do(
            "MoveTipTo",
            positionMm=goal.tolist(),
            direction=(direction / np.linalg.norm(direction)).tolist(),
            speedMmS=speed_mm_s,
        )
        return goal

    def _off(self, goal: np.ndarray) -> float:
        """Return how far the tip is from a place in World, mm."""
        tip = np.array(self._player.latest["ToolTipToWorld"].content.matrix)[:3, 3]
        return float(np.linalg.norm(tip - goal))


@pytest.fixture(scope="module")
def seen(tmp_path_factory) -> dict:
    """Observations of a trial, which the simulator scores before Slicer's side comes."""
    folder = tmp_path_factory.mktemp("surface")
    records, scenario_folder = folder / "records", write_landmarked(folder / "scenario")
    scenario = load_scenario(scenario_folder)
    seen = {"scenario": scenario, "study": folder / "study.db"}
    options = ("--scenario", str(scenario_folder), "--speed", SPEED, "--no-views")
    with SimulatorProcess(records, *options) as simulator:
        with Player(simulator.port) as player:
            trainee = TracingTrainee(player, scenario, SEED)
            seen["trial"] = trainee.start("surface")
            for corners in OVER_THE_FACE:
                trainee.trace(corners)
            player.do("Register")
            seen["offer"] = player.next_offer()
        # No client is connected any longer: the simulator registers and scores the trial itself.
        (seen["journal"],) = records.glob("*.journal")
        wait_until(lambda: read_journal(seen["journal"]).of_kind("scored"), "its own score")
        reading = read_journal(seen["journal"])
        for kind in ("registration", "scored"):
            seen[kind] = reading.of_kind(kind)[0]["arguments"]
        find = lambda _name: scenario  # noqa: E731
        slicer = SlicerSide(seen["study"], simulator.port, TrialLogic, find, records)
        scored, problems = [], []
        slicer.logic.trialScored.connect(scored.append)
        slicer.logic.problemFound.connect(problems.append)
        give_up = time.monotonic() + TIMEOUT_S
        while not scored and time.monotonic() < give_up:
            slicer.run_for(10)
        slicer.close()
    assert problems == []
    return seen | {"analysis": scored[0]}


def test_the_record_has_the_landmarks_the_trace_and_little_unintended_contact(seen):
    record = record_from_json(TrialRecord, seen["offer"])
    assert record.method is RegistrationMethod.SURFACE
    assert record.labels == tuple(landmark.name for landmark in LANDMARKS[:3])
    assert 150 < len(record.trace) <= 500
    steps = np.linalg.norm(np.diff(record.trace_mm, axis=0), axis=1)
    assert steps.min() >= 1.0 - 1e-9
    assert np.median(steps) < 1.5
    unintended_s = record.motion["unintended_contact_time_s"]
    assert unintended_s < 0.2 * record.motion["contact_time_s"]
    assert record.completion_time_s > record.trace[-1][3] - record.trace[0][3]


def test_the_trial_replays_to_the_last_bit(seen):
    reading = read_journal(seen["journal"])
    assert reading.integrity is Integrity.INTACT
    report = replay(reading, setup_of(reading.header, seen["scenario"].folder))
    assert report.difference is None
    assert report.compared["trace"] == len(reading.of_kind("trace"))


def test_the_simulator_and_slicer_register_and_score_it_identically_to_the_last_digit(seen):
    registration, scored, analysis = seen["registration"], seen["scored"], seen["analysis"]
    assert registration["matrix"] == analysis.rigid.matrix.ravel().tolist()
    assert registration["freMm"] == analysis.rigid.fre_mm < 0.5
    assert scored["score"] == analysis.score.score
    assert analysis.score.version == scored["details"]["scoreVersion"] == SCORE_VERSION
    assert analysis.score.is_accurate
    assert analysis.truth.true_tre_mm < 1.0
    assert analysis.score.measures.common_bias_mm is None


def test_slicer_stores_the_trace_and_exports_it(seen, tmp_path):
    with Study.open(seen["study"]) as study:
        stored = study.trial(seen["trial"])
    assert stored.record == record_from_json(TrialRecord, seen["offer"])
    names = [path.name for path in write_slicer_files(stored, tmp_path)]
    assert {"traced-world.mrk.json", "traced-ras.mrk.json"} <= set(names)
    written = read_markups(tmp_path / "traced-world.mrk.json").points
    np.testing.assert_allclose(written, stored.record.trace_mm, atol=1e-9)
