"""Slicer's process is killed among the touches and in each phase of a procedure, and comes back."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from rastrainer.protocol import PROCEDURE_PHASES
from rastrainer.scenario.scenario import load_scenario
from rastrainer.study.database.study import Study
from rastrainer_simulator.assets import asset_path
from Testing.end_to_end.lab import SlicerProcess
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.end_to_end.test_trial_over_openigtlink import SPEED, Player, play

# A process of Slicer's side is started six times.
pytestmark = pytest.mark.soak

COLIN = asset_path("scenarios", "colin27")
PROCEDURE = "biopsy"
KILLED_AFTER = 7
STAND_OFF_MM, DRILLED_MM, PLACED_MM = 30.0, 50.0, 72.0
TIMEOUT_S = "600"


class KilledSlicer:
    """Slicer's side, each time as a new process on the same study.

    Attributes:
        points: how many touches the current process has received.
        kills: the phases in which the previous simulators were killed.
    """

    def __init__(self, folder: Path, port: int):
        self._words = (
            *("--port", str(port), "--trials", "1", "--timeout", TIMEOUT_S),
            *("--assets", str(asset_path()), "--output", str(folder / "study")),
        )
        self.kills: list[str] = []
        self._start()

    def _start(self) -> None:
        self.process = SlicerProcess(*self._words)
        while self.process.events_until("status")[-1]["state"] != "connected":
            pass

    def kill_and_return(self, phase: str) -> None:
        """Kill the process by signal 9, and start another one."""
        self.process.kill()
        self.kills.append(phase)
        self._start()

    def touches_reported(self, count: int) -> list[str]:
        """Return the labels of a number of touches, as soon as they are reported."""
        return [self.process.events_until("point")[-1]["label"] for _ in range(count)]


class Interrupted(Player):
    """Has Slicer killed after some touches."""

    def __init__(self, port: int, slicer: KilledSlicer):
        self._slicer, self._touches = slicer, 0
        self.reported: list[str] = []
        super().__init__(port)

    def do(self, name: str, **arguments) -> dict:
        reply = super().do(name, **arguments)
        if name == "Capture":
            self._touches += 1
            if self._touches == KILLED_AFTER:
                self._slicer.kill_and_return("running")
                self.reported = self._slicer.touches_reported(KILLED_AFTER)
        return reply

    def state(self, is_wanted) -> dict:
        found = self.wait_for(
            "SimState", lambda message: is_wanted(json.loads(message.content.text)), 60
        )
        return json.loads(found.content.text)

    def feed(self, to_mm: float) -> None:
        """Feed the instrument in the guide to a depth."""
        while (depth := self.state(bool)["procedure"]["feedMm"]) < to_mm:
            self.do("Feed", velocityMmS=5.0, durationS=2.0)
            self.state(lambda state, before=depth: state["procedure"]["feedMm"] > before)

    def until_in(self, phase: str) -> None:
        self.state(lambda state: state["phase"] == phase)


def lose(player: Interrupted, slicer: KilledSlicer, phase: str) -> None:
    """Lose Slicer in a phase; the simulator stays in it, by the registration that it has."""
    player.until_in(phase)
    slicer.kill_and_return(phase)
    state = player.state(bool)
    assert (state["phase"], state["procedure"]["registrationInUse"]) == (phase, True)


@pytest.fixture(scope="module")
def seen(tmp_path_factory) -> dict:
    """A biopsy by commands, whose Slicer is killed in each phase and scores it at last."""
    folder = tmp_path_factory.mktemp("killed")
    with SimulatorProcess(folder / "records", "--speed", SPEED) as simulator:
        slicer = KilledSlicer(folder, simulator.port)
        try:
            with Interrupted(simulator.port, slicer) as player:
                answers = play(player, load_scenario(COLIN), procedure=PROCEDURE)
                player.state(lambda state: state["procedure"]["registrationInUse"])
                lose(player, slicer, "verifying")
                player.do("AcceptRegistration")
                lose(player, slicer, "aligning")
                player.do("AlignGuide", standOffMm=STAND_OFF_MM)
                player.state(is_aligned)
                player.do("LockGuide")
                player.feed(DRILLED_MM / 2)
                lose(player, slicer, "drilling")
                player.feed(DRILLED_MM)
                player.do("StartInsertion")
                player.feed(PLACED_MM / 2)
                lose(player, slicer, "inserting")
                player.feed(PLACED_MM)
                player.do("ReleaseInstrument")
                events = slicer.process.events_until("trial")
        finally:
            slicer.process.kill()
    with Study.open_for_reading(folder / "study" / "study.db") as study:
        stored = study.history("anna")
    return {"player": player, "slicer": slicer, "events": events, "stored": stored} | answers


def is_aligned(state: dict) -> bool:
    here = state["procedure"]
    off = (here["entryDistanceMm"], here["angleDeg"])
    return None not in off and max(off) < 0.01 and abs(here["standOffMm"] - STAND_OFF_MM) < 0.01


def test_slicer_is_killed_during_the_touches_and_in_each_phase(seen):
    assert seen["slicer"].kills == ["running", *(phase.value for phase in PROCEDURE_PHASES)]


def test_a_slicer_that_returns_during_the_touches_receives_all_earlier_ones(seen):
    assert seen["player"].reported == [str(number) for number in range(1, KILLED_AFTER + 1)]


def test_touches_from_before_and_after_slicers_return_are_registered(seen):
    (stored,) = seen["stored"]
    (attempt,) = stored.record.procedure.attempts
    assert [touch.label for touch in attempt.touches] == [str(n) for n in range(1, 16)]


def test_the_trial_is_scored_once_with_its_procedure(seen):
    (stored,) = seen["stored"]
    assert stored.record.trial_id == seen["StartTask"]["trialId"]
    assert stored.score is not None
    assert stored.procedure.score.version == "procedure-1"
    assert [event for event in seen["events"] if event["event"] == "problem"] == []
