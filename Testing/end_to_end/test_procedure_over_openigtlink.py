"""A whole procedure over OpenIGTLink, against a simulator that is killed in each of its phases."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.json_records import record_from_json
from rastrainer.protocol import Phase
from rastrainer.scenario.scenario import load_scenario
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.touch_registration import GivenPoints, register_trial
from rastrainer_simulator.record.trial_context import setup_of
from rastrainer_simulator.replay.resimulation import replay
from Testing.end_to_end.onto_skin import lower_onto_skin
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.end_to_end.test_trial_over_openigtlink import SPEED, Player, play
from Testing.simulator.planned_procedures import write_scenario

# Slicer and the journal are also tested like this in each phase, which takes less time.
pytestmark = pytest.mark.soak

STAND_OFF_MM = 25.0
DRILLED_MM = 60.0
PLACED_MM = 70.0
ROUNDED_MM = 0.001
"""States and the journal are rounded."""
FED_MM = 20.0
"""Most that one command feeds."""


class Surgeon:
    """A client that carries out a procedure; the server is killed and started again meanwhile."""

    def __init__(self, folder: Path):
        self.records = folder / "records"
        self.scenario = write_scenario(folder / "scenario")
        self.resumed: list[dict] = []
        self._start()

    def _start(self) -> None:
        options = ("--scenario", str(self.scenario), "--speed", SPEED)
        self.simulator = SimulatorProcess(self.records, *options)
        self.player = Player(self.simulator.port)

    def close(self) -> None:
        self.player.close()
        self.simulator.kill()

    def kill_and_resume(self, depth_mm: float = 0.0) -> dict:
        """Kill the server, start it again, and resume; return the state that it resumed in.

        Args:
            depth_mm: which the journal holds before the server is killed.
        """
        while self.written_mm() < depth_mm:
            self.state(bool)
        self.close()
        self._start()
        paused = self.state(lambda state: state["phase"] == Phase.PAUSED.value)
        self.player.do("Resume")
        resumed = self.state(lambda state: state["phase"] != Phase.PAUSED.value)
        self.resumed.append(resumed)
        return paused

    def state(self, is_wanted) -> dict:
        found = self.player.wait_for(
            "SimState", lambda message: is_wanted(json.loads(message.content.text)), 60
        )
        return json.loads(found.content.text)

    def procedure(self, is_wanted=bool) -> dict:
        return self.state(lambda state: is_wanted(state["procedure"]))["procedure"]

    def written_mm(self) -> float:
        """Return the depth that the journal holds last; 0 before the first one."""
        (journal,) = self.records.glob("*.journal")
        samples = read_journal(journal).of_kind("sample")
        return samples[-1].get("feedMm", 0.0) if samples else 0.0

    def feed(self, tool: str, to_mm: float, velocity_mm_s: float) -> None:
        """Feed a tool repeatedly until the state reports the depth."""
        while (before := self.depth(tool)) < to_mm:
            self.player.do("Feed", velocityMmS=velocity_mm_s, durationS=2.0)
            self.depth(tool, before)

    def depth(self, tool: str, after: float = -1.0) -> float:
        """Return how deep a tool is, as soon as it is deeper than before."""

        def is_news(procedure: dict) -> bool:
            return procedure["tool"] == tool and procedure["feedMm"] > after

        return self.procedure(is_news)["feedMm"]


@pytest.fixture(scope="module")
def seen(tmp_path_factory) -> dict:
    """A client's observations of a procedure with two lines."""
    surgeon = Surgeon(tmp_path_factory.mktemp("procedure"))
    try:
        return perform(surgeon) | {"surgeon": surgeon}
    finally:
        surgeon.close()


def perform(surgeon: Surgeon) -> dict:
    scenario = load_scenario(surgeon.scenario)
    seen = {"tasks": surgeon.player.do("ListTasks")}
    seen |= play(surgeon.player, scenario, procedure="dbs")
    trial_id = seen["StartTask"]["trialId"]
    surgeon.kill_and_resume()
    answer = surgeon.player.do("GetTrial", trialId=trial_id)
    registered = register_trial(GivenPoints.of_answer(answer), scenario)
    seen["UseRegistration"] = surgeon.player.do("UseRegistration", **registered.arguments(trial_id))
    head_to_world = transforms.inverse(registered.rigid.matrix)
    check = transforms.apply(head_to_world, scenario.procedures[0].checkpoints[0].position_ras)
    seen["checked"] = touch_checkpoint(surgeon, check, head_to_world, scenario)
    surgeon.kill_and_resume()
    surgeon.player.do("AcceptRegistration")
    seen["aligned"], seen["paused drill"], seen["paused instrument"] = [], [], []
    for number in range(2):
        surgeon.player.do("AlignGuide", standOffMm=STAND_OFF_MM)
        if number == 0:
            surgeon.kill_and_resume()
            surgeon.player.do("AlignGuide", standOffMm=STAND_OFF_MM)
        seen["aligned"].append(surgeon.procedure(is_aligned_with(number)))
        surgeon.player.do("LockGuide")
        surgeon.feed("drill", DRILLED_MM, 5.0)
        if number == 0:
            seen["drilled"] = surgeon.procedure()
            seen["paused drill"] = surgeon.kill_and_resume(seen["drilled"]["feedMm"])
        surgeon.player.do("StartInsertion")
        surgeon.feed("electrode", PLACED_MM, 10.0)
        if number == 1:
            seen["inserted"] = surgeon.procedure()
            seen["paused instrument"] = surgeon.kill_and_resume(seen["inserted"]["feedMm"])
        surgeon.player.do("ReleaseInstrument")
    seen["offer"] = surgeon.player.next_offer()
    seen["before"] = surgeon.player.do("GetTrial", trialId=trial_id)
    seen["truth"] = surgeon.player.do("SubmitRegistration", **registered.arguments(trial_id))
    surgeon.player.do("TrialScored", trialId=trial_id, score=77)
    seen["scored"] = surgeon.state(lambda state: state["phase"] == Phase.SCORED.value)
    surgeon.player.do("AcknowledgeTrial", trialId=trial_id)
    seen["exit"] = surgeon.simulator.stop()
    (seen["journal"],) = surgeon.records.glob("*.journal")
    return seen


def touch_checkpoint(surgeon: Surgeon, place, head_to_world, scenario) -> dict:
    center = transforms.apply(head_to_world, scenario.target.position_ras)
    outward = (place - center) / np.linalg.norm(place - center)
    surgeon.player.move_to(place + 40.0 * outward)
    lower_onto_skin(surgeon.player, place, center)
    return surgeon.player.do("Capture")


def is_aligned_with(number: int):
    def is_aligned(procedure: dict) -> bool:
        if (procedure["tool"], procedure["trajectory"]) != ("guide", number):
            return False
        off = abs(procedure["standOffMm"] - STAND_OFF_MM)
        return max(procedure["entryDistanceMm"], procedure["angleDeg"], off) < 0.001

    return is_aligned


def test_the_procedures_are_listed_with_their_lines(seen):
    listed = {each["name"]: each for each in seen["tasks"]["procedures"]}
    assert listed["dbs"] == {
        "name": "dbs",
        "title": "Dbs",
        "kind": "dbs",
        "trajectories": ["Line 0", "Line 1"],
    }


def test_after_each_kill_the_procedure_continues_in_its_phase(seen):
    assert [state["phase"] for state in seen["surgeon"].resumed] == [
        "verifying",
        "verifying",
        "aligning",
        "drilling",
        "inserting",
    ]
    assert [state["procedure"]["registrationInUse"] for state in seen["surgeon"].resumed] == [
        False,
        *(True,) * 4,
    ]


@pytest.mark.parametrize(
    ("before", "after"), [("drilled", "paused drill"), ("inserted", "paused instrument")]
)
def test_drilling_and_insertion_recorded_in_the_journal_survive_a_kill(seen, before, after):
    depth_mm = seen[before]["feedMm"]
    assert depth_mm - ROUNDED_MM <= seen[after]["procedure"]["feedMm"] <= depth_mm + 2 * FED_MM
    assert seen[after]["procedure"]["tool"] == seen[before]["tool"]


def test_the_robot_aligns_the_guide_exactly_with_the_plan(seen):
    for aligned in seen["aligned"]:
        assert aligned["entryDistanceMm"] <= 0.05
        assert aligned["angleDeg"] <= 0.05


def test_the_record_holds_the_whole_procedure(seen):
    record = record_from_json(TrialRecord, seen["offer"])
    procedure = record.procedure
    assert (procedure.procedure, procedure.kind.value) == ("dbs", "dbs")
    (attempt,) = procedure.attempts
    assert attempt.registration.matrix == tuple(seen["UseRegistration"]["registration"]["matrix"])
    (checkpoint,) = attempt.checkpoints
    assert checkpoint.name == seen["checked"]["checkpoint"] == "Check 0"
    assert checkpoint.error_mm == seen["checked"]["errorMm"]
    for instrument in procedure.instruments:
        assert instrument.self_aligned
        assert instrument.alignments == 1
        # The next command comes while the previous command still feeds the tool.
        beyond = (
            instrument.drill_depth_mm - DRILLED_MM,
            instrument.instrument_depth_mm - PLACED_MM,
        )
        assert min(beyond) >= -ROUNDED_MM
        assert max(beyond) <= 2 * FED_MM
        assert instrument.feed["drill_path_mm"] >= instrument.drill_depth_mm - 5.0
    assert record.completion_time_s < procedure.duration_s
    assert sum(procedure.phase_times_s.values()) == pytest.approx(procedure.duration_s)


def test_the_truth_stays_secret_until_the_registration_is_submitted(seen):
    found = [seen[name] for name in ("UseRegistration", "checked", "offer", "before")]
    assert "headToWorld" not in json.dumps(found)
    assert "headToWorld" in seen["truth"]
    assert seen["scored"]["phase"] == "scored"


def test_the_trial_replays_to_the_last_bit_through_all_its_interruptions(seen):
    reading = read_journal(seen["journal"])
    assert reading.integrity is Integrity.INTACT
    report = replay(reading, setup_of(reading.header, seen["surgeon"].scenario))
    assert report.difference is None
    assert report.compared["continued"] == 5
    assert report.compared["checkpoint"] == 1
    assert report.compared["feed"] >= 4
    assert seen["exit"] == (0, "")
