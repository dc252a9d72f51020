"""A drill survives the simulator's death in a case, is stored once, and is a study's step."""

from __future__ import annotations

import json
import subprocess
import sys
import threading

import pytest

from rastrainer.decision.drill_record import CASES, DrillRecord
from rastrainer.igtl.client import Client
from rastrainer.journal.folder import DRILL_SUFFIX
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.json_records import record_from_json
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.decision.drill import CLOCK_S
from rastrainer_simulator.virtual.scripted_trial import send_hello
from Testing.end_to_end.drilling_simulator import SAYS
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.end_to_end.study_side import RECORDS, STUDY, StudySide
from Testing.end_to_end.window_process import wait_until

TIMEOUT_S = 120.0


class Drilling(SimulatorProcess):
    """A simulator whose trainee obeys the test."""

    command = (sys.executable, "-m", "Testing.end_to_end.drilling_simulator")

    def __init__(self, records, trainee="P01"):
        super().__init__(records, "--no-gamepad", "--view-port", "0", stdin=subprocess.PIPE)
        self._ask(trainee)

    def do(self, *deeds):
        """Do some deeds; return the drill's last state."""
        for deed in deeds:
            self._ask(deed)
        answers = [deed for deed in deeds if deed != "next"]
        return [self._answer() for _ in answers][-1]

    def _ask(self, line):
        self._process.stdin.write(line + "\n")
        self._process.stdin.flush()

    def _answer(self):
        while not (line := self.next_line()).startswith(SAYS):
            assert line or self._process.poll() is None, self.wait()
        return json.loads(line.removeprefix(SAYS))


class Scorer(Client):
    """A client that registers and scores, and keeps the offers it gets."""

    def __init__(self, port):
        self.offers, self.news = [], threading.Condition()
        super().__init__(port=port, on_message=self._keep)
        send_hello(self, "tester")

    def _keep(self, message):
        if message.device == "command":
            with self.news:
                self.offers.append((message.content.name, json.loads(message.content.body)))
                self.news.notify_all()

    def offered(self):
        with self.news:
            assert self.news.wait_for(lambda: self.offers, TIMEOUT_S)
            return self.offers[-1]


@pytest.fixture
def study(tmp_path):
    """A study whose protocol begins and ends with drills."""
    plan = StudyProtocol.read(asset_path("studies", "published-protocol.json")).to_json()
    plan |= {"modes": ["desktop"], "questionnaires": [], "drills": ["before-all", "after-all"]}
    with Study.open(tmp_path / STUDY) as study:
        study.create_trainee("P01")
        progress = StudyProgress(study)
        progress.set_protocol(StudyProtocol.from_json(plan))
        progress.enroll("P01")
        yield study


def test_a_drill_killed_in_mid_case_continues_and_is_delivered_and_stored_once(tmp_path, study):
    records = tmp_path / RECORDS
    with Drilling(records) as simulator, StudySide(tmp_path, simulator.port):
        decided = simulator.do("see", "check", "decide", "next", "see")
        assert (decided["number"], decided["checks"]) == (2, [])
        before = simulator.do("check", "read", "see")
        simulator.kill()
    with Drilling(records) as simulator, Scorer(simulator.port) as scorer:
        after = simulator.do("see")
        same = "trialId", "number", "checks", "hasReadImages", "isDecided", "seed"
        assert {key: after[key] for key in same} == {key: before[key] for key in same}
        assert after["timeS"] > before["timeS"] - CLOCK_S
        rest = ["decide", *["next", "decide"] * (CASES - 2)]
        simulator.do(*rest[:-1])
        assert scorer.offers == []
        trial = {"trialId": after["trialId"]}
        assert not scorer.send_command("GetTrial", trial, TIMEOUT_S).ok
        simulator.do(rest[-1])
        name, body = scorer.offered()
        assert (name, body["task"]) == ("TrialCompleted", "decide")
        record = record_from_json(DrillRecord, body)
        assert (record.trial_id, record.trainee) == (after["trialId"], "P01")
        assert (len(record.cases), record.cases[1].seed) == (CASES, before["seed"])
        assert record.cases[1].checks == ("tip",)
        simulator.kill()
    (path,) = records.glob(f"*{DRILL_SUFFIX}")
    assert read_journal(path).integrity is Integrity.INTACT
    with SimulatorProcess(records, "--no-views") as simulator, Scorer(simulator.port) as scorer:
        assert record_from_json(DrillRecord, scorer.offered()[1]) == record
        registration = {"matrix": [1.0 * (i % 5 == 0) for i in range(16)], "freMm": 1.0}
        for command, more in (
            ("SubmitRegistration", {**registration, "expectedTreMm": 1.0}),
            ("TrialScored", {"score": 100.0}),
        ):
            assert not scorer.send_command(command, {**trial, **more}, TIMEOUT_S).ok
        with StudySide(tmp_path, simulator.port):
            wait_until(lambda: study.drills("P01"), "the stored drill")

            def is_acknowledged():
                return scorer.send_command("GetTrial", trial, TIMEOUT_S).data["acknowledged"]

            wait_until(is_acknowledged, "the acknowledgement")
        assert scorer.send_command("AcknowledgeTrial", trial, TIMEOUT_S).ok
        assert simulator.stop()[0] == 0
    assert len(read_journal(path).of_kind("acknowledged")) == 1
    assert study.drills("P01") == (record,)
    progress = StudyProgress(study)
    assert progress.count_played("P01").counted_trials == (record.trial_id,)
    assert progress.progress("P01").next_step.name == "desktop/trial-run"
    study.delete_trainee("P01")
    assert study.is_deleted(record.trial_id)
