"""No client makes a trial vanish, or leaves it without a score: attacks on the real simulator."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.igtl.client import Client
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.scenario.scenario import load_scenario
from rastrainer.sections.trial_logic import TrialLogic
from rastrainer.study.database.study import Study
from Testing.end_to_end.faulty_proxy import SlicerSide
from Testing.end_to_end.finished_trials import COLIN, write_finished_trials
from Testing.end_to_end.registered_trial import registration_of
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.end_to_end.test_trial_over_openigtlink import SEED, Player, play
from Testing.slicer.simulator_double import run_logic_until

TIMEOUT_S = 120.0
HELLO = {"protocolVersion": PROTOCOL_VERSION, "client": "bystander"}
IDENTITY = {"matrix": np.eye(4).ravel().tolist(), "freMm": 0.0, "expectedTreMm": 0.0}


@pytest.fixture
def simulator(tmp_path):
    with SimulatorProcess(tmp_path / "records", "--no-views", "--speed", "8") as simulator:
        yield simulator


@pytest.fixture
def scenario():
    return load_scenario(COLIN)


def slicer_for_aborted(folder, simulator):
    """Return Slicer's side, once the simulator knows it."""
    side = SlicerSide(folder / "study.db", simulator.port, TrialLogic)
    run_logic_until(side.link, side.work, lambda: side.link.seen.isOpen, TIMEOUT_S)
    return side


def aborted_trial(client, trainee="T-001"):
    """Play a trial with a refused touch, and abort it."""
    trial = client.send_command("StartTask", {"task": "task-1", "trainee": trainee}).data["trialId"]
    client.send_command("Capture")
    assert client.send_command("Abort").ok
    return trial


def stored(folder, trainee="T-001"):
    with Study.open(folder / "study.db") as study:
        if trainee not in {each.pseudonym for each in study.trainees()}:
            return set()
        return {each.trial_id for each in study.aborted(trainee)}


def test_an_aborted_trial_that_a_bystander_acknowledges_reaches_the_study(simulator, tmp_path):
    slicer = slicer_for_aborted(tmp_path, simulator)
    try:
        with Client(port=simulator.port) as bystander:
            trials = set()
            for _ in range(3):
                if trials:
                    bystander.send_command("Hello", HELLO)
                trials.add(trial := aborted_trial(bystander))
                bystander.send_command("AcknowledgeTrial", {"trialId": trial})
            run_logic_until(slicer.link, slicer.work, lambda: stored(tmp_path) == trials, TIMEOUT_S)
    finally:
        slicer.close()


def test_a_trial_that_was_acknowledged_while_slicer_was_away_is_a_gap_in_the_study(
    simulator, tmp_path
):
    with Client(port=simulator.port) as player:
        first = aborted_trial(player)
        offered = []
        with Client(
            port=simulator.port,
            on_message=lambda message: message.device == "command" and offered.append(message),
        ) as thief:
            thief.send_command("Hello", HELLO)
            lost = aborted_trial(player)
            acknowledged = set()
            while lost not in acknowledged:
                thief.wait_for("SimServer", timeout=TIMEOUT_S)
                if thief.send_command("AcknowledgeTrial", {"trialId": lost}).ok:
                    acknowledged.add(lost)
        last = aborted_trial(player)
        slicer = slicer_for_aborted(tmp_path, simulator)
        try:
            run_logic_until(
                slicer.link, slicer.work, lambda: stored(tmp_path) == {first, last}, TIMEOUT_S
            )
        finally:
            slicer.close()
    with Study.open(tmp_path / "study.db") as study:
        (gaps,) = study.undelivered().values()
    assert gaps == ((2, 2),)


def test_a_foreign_registration_neither_reveals_the_truth_nor_leaves_a_trial_without_a_score(
    tmp_path, scenario
):
    records = tmp_path / "records"
    records.mkdir()
    (trial,) = write_finished_trials(records, range(1))
    with SimulatorProcess(records, "--no-views") as simulator:
        with Client(port=simulator.port) as bystander:
            for hello in (None, HELLO):
                if hello:
                    bystander.send_command("Hello", hello)
                reply = bystander.send_command("SubmitRegistration", {"trialId": trial, **IDENTITY})
                assert not reply.ok
                assert "headToWorld" not in reply.data
            assert "must be the rigid one of the trial's points" in reply.error
        scored = []
        find = lambda _name: scenario  # noqa: E731
        slicer = SlicerSide(tmp_path / "study.db", simulator.port, TrialLogic, find)
        slicer.logic.trialScored.connect(scored.append)
        try:
            run_logic_until(slicer.link, slicer.work, lambda: scored, TIMEOUT_S)
            with Client(port=simulator.port) as bystander:
                bystander.send_command("Hello", HELLO)
                other = bystander.send_command("TrialScored", {"trialId": trial, "score": 100.0})
                assert other.ok
        finally:
            slicer.close()
    with Study.open(tmp_path / "study.db") as study:
        assert 0.0 < study.trial(trial).score.score < 100.0


def test_a_procedure_continues_only_with_the_registration_of_its_touches(simulator, scenario):
    (procedure, *_) = scenario.procedures
    with Player(simulator.port) as player:
        trial = play(player, scenario, procedure=procedure.name)["StartTask"]["trialId"]
        truth = transforms.inverse(scenario.perturbed_head_to_world(SEED))
        known = {"trialId": trial, **IDENTITY, "matrix": truth.ravel().tolist()}
        refused = player.send_command("UseRegistration", known)
        assert "must be the rigid one of the trial's points" in refused.error
        fit = registration_of(player, trial, scenario)
        assert player.do("UseRegistration", **fit)["registration"]["matrix"] == fit["matrix"]
