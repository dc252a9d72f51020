"""A drill survives the simulator's death in mid case, and is delivered and acknowledged once."""

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
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer_simulator.decision.drill import CLOCK_S
from Testing.end_to_end.drilling_simulator import SAYS
from Testing.end_to_end.simulator_process import SimulatorProcess

TIMEOUT_S = 120.0


class Drilling(SimulatorProcess):
    """A simulator whose trainee does what is asked."""

    command = (sys.executable, "-m", "Testing.end_to_end.drilling_simulator")

    def __init__(self, records, trainee="P01"):
        super().__init__(records, "--no-gamepad", "--view-port", "0", stdin=subprocess.PIPE)
        self._ask(trainee)

    def do(self, *deeds):
        """Return what is seen after the last of some deeds."""
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
        hello = {"protocolVersion": PROTOCOL_VERSION, "client": "tester"}
        assert self.send_command("Hello", hello, TIMEOUT_S).ok

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
def records(tmp_path):
    return tmp_path / "records"


def test_a_drill_killed_in_mid_case_continues_there_and_is_delivered_once(records):
    with Drilling(records) as simulator:
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
        for _ in range(2):
            assert scorer.send_command("AcknowledgeTrial", trial, TIMEOUT_S).ok
        assert scorer.send_command("GetTrial", trial, TIMEOUT_S).data["acknowledged"]
        assert simulator.stop()[0] == 0
    assert len(read_journal(path).of_kind("acknowledged")) == 1
