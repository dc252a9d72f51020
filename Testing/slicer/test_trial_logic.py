"""A trial is stored once and acknowledged when stored; a finished one is scored and shown."""

import threading
import uuid

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.igtl.content import String
from rastrainer.protocol import DeviceName
from rastrainer.sections import trial_logic
from rastrainer.sections.trial_logic import TrialLogic
from rastrainer.sections.trial_services import TrialServices
from rastrainer.slicer import background_work
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.scene.nodes import Role
from rastrainer.slicer.scene.trial_scene import isApplied
from rastrainer.study.database.database import LockWait, StudyUnreachableError
from rastrainer.study.database.study import Study
from rastrainer.study.delivered_trial import scored_with_journal
from rastrainer.trial.analysis import analyze_trial
from Testing.domain.trial.trial_records import make_aborted
from Testing.slicer.simulator_double import LinkedLab

TRIAL = str(uuid.UUID(int=1))
OTHER = str(uuid.UUID(int=2))
SEED = 1
ABORTED = make_aborted()["trialId"]


class Lab(LinkedLab):
    """A logic on a link to a simulator whose answers the test may change."""

    def __init__(self, scene, scenario, folder):
        super().__init__(scene, self.answer)
        self.scenario = scenario
        self.path = folder / "study.db"
        self.refusal = None
        self.is_study_broken = False
        self.threads = set()
        self.scored, self.problems, self.kept = [], [], []
        self.start()

    def start(self):
        find, open_study = self.find_scenario, lambda: self.open_study()
        self.logic = TrialLogic(TrialServices(self.scene, self.link, find, open_study, self.work))
        self.logic.abortedKept.connect(self.kept.append)
        self.logic.trialScored.connect(self.scored.append)
        self.logic.problemFound.connect(self.problems.append)

    def answer(self, name, arguments):
        if name != "SubmitRegistration":
            return {}
        if self.refusal is not None:
            return self.refusal
        head_to_world = self.scenario.perturbed_head_to_world(SEED)
        target = self.scenario.target.position_ras
        found = np.reshape(arguments["matrix"], (4, 4)) @ head_to_world
        return {
            "headToWorld": head_to_world.ravel().tolist(),
            "trueTreMm": float(np.linalg.norm(transforms.apply(found, target) - target)),
        }

    def find_scenario(self, name):
        if name != self.scenario.name:
            raise InputError(f"The scenario {name} is not here.")
        return self.scenario

    def open_study(self):
        self.threads.add(threading.get_ident())
        if self.is_study_broken:
            raise InputError("The disk is full.")
        return Study.open(self.path, LockWait(0.01))

    def stored(self, trial_id=TRIAL):
        return self.in_study(lambda study: study.trial(trial_id))

    def in_study(self, do):
        with Study.open(self.path) as study:
            return do(study)

    def receive(self, record):
        self.simulator.send_command("TrialCompleted", record)

    def count(self):
        """How many trials the trainee has in the study."""
        return self.in_study(lambda study: len(study.history("T-001")))

    def close(self):
        self.link.disconnect()
        self.logic.close()
        super().close()


@pytest.fixture
def lab(scene, scenario, tmp_path):
    lab = Lab(scene, scenario, tmp_path)
    lab.connect()
    yield lab
    lab.close()


@pytest.fixture
def reviews(monkeypatch):
    """UUID and thread of each registration and each scoring."""
    done = []

    def registered(record, *arguments, **options):
        done.append((record.trial_id, threading.get_ident()))
        return analyze_trial(record, *arguments, **options)

    def scored(analysis, *arguments):
        done.append((analysis.record.trial_id, threading.get_ident()))
        return scored_with_journal(analysis, *arguments)

    monkeypatch.setattr("rastrainer.study.delivered_trial.analyze_trial", registered)
    monkeypatch.setattr("rastrainer.study.delivered_trial.scored_with_journal", scored)
    return done


def test_a_finished_trial_is_stored_acknowledged_scored_and_shown_not_by_the_main_thread(
    lab, make_record, reviews
):
    lab.receive(make_record(TRIAL, seed=SEED))
    lab.run_until(lambda: lab.scored)
    stored = lab.stored()
    names = ["Hello", "AcknowledgeTrial", "SubmitRegistration", "TrialScored"]
    assert [name for name, _ in lab.simulator.commands] == names
    assert set(stored.registrations) == {"rigid", "similarity", "affine"}
    assert stored.score.score == lab.sent("TrialScored")[0]["score"]
    assert stored.true_tre_mm == lab.scored[0].truth.true_tre_mm
    expected = lab.scenario.perturbed_head_to_world(SEED)
    np.testing.assert_allclose(np.reshape(stored.truth.head_to_world, (4, 4)), expected)
    assert isApplied(Role.WORLD_TO_HEAD.find(lab.scene))
    for role in (Role.RESIDUALS, Role.FITS, Role.RESIDUAL_ARROWS, Role.HEAD_MODEL):
        assert role.find(lab.scene) is not None
    # Once to register it, once with its truth.
    assert len(reviews) == 2
    assert threading.get_ident() not in lab.threads | {thread for _trial, thread in reviews}


def test_delivering_twice_stores_and_scores_once(lab, make_record, reviews):
    for _ in range(3):
        lab.receive(make_record(TRIAL))
    lab.run_until(lambda: lab.scored)
    acknowledged = len(lab.all_sent("AcknowledgeTrial"))
    for count in (1, 2):
        lab.receive(make_record(TRIAL))
        lab.run_until(lambda count=count: len(lab.sent("AcknowledgeTrial")) == acknowledged + count)
    assert (len(lab.scored), len(reviews)) == (1, 2)
    assert len(lab.all_sent("TrialScored")) == 1
    assert lab.count() == 1


def test_a_trial_is_not_acknowledged_before_it_is_stored(lab, make_record):
    lab.is_study_broken = True
    for _ in range(3):
        lab.link.trialCompleted.emit(make_record(TRIAL))
        lab.run_until(lambda: not lab.work.isBusy)
    (problem,) = lab.problems
    assert "The disk is full" in problem
    assert not lab.all_sent("AcknowledgeTrial")
    lab.is_study_broken = False
    lab.receive(make_record(TRIAL))
    lab.run_until(lambda: lab.sent("AcknowledgeTrial"))
    assert lab.stored().record.trial_id == TRIAL


@pytest.mark.parametrize(
    ("changes", "refusal", "said", "has_truth"),
    [
        pytest.param({"scenario": "elsewhere"}, None, "elsewhere is not here", False, id="head"),
        pytest.param({}, "There is no such trial.", "no such trial", False, id="refused"),
        pytest.param({"motion": {}}, None, "contacts were not measured", True, id="unmeasured"),
    ],
)
def test_a_trial_that_cannot_be_scored_is_reported_and_stored_with_its_truth_if_there_is_one(
    lab, make_record, changes, refusal, said, has_truth
):
    lab.refusal = refusal
    lab.receive(make_record(TRIAL, **changes))
    lab.run_until(lambda: lab.problems and lab.sent("AcknowledgeTrial"))
    assert said in lab.problems[0]
    assert lab.stored().score is None
    assert (lab.stored().true_tre_mm is not None) == has_truth
    assert not lab.all_sent("TrialScored")


@pytest.mark.parametrize("by_reconnecting", [True, False], ids=["reconnected", "connected"])
def test_a_trial_is_scored_once_its_unreachable_study_is_back(
    by_reconnecting, lab, make_record, monkeypatch
):
    monkeypatch.setattr(trial_logic, "RETRY_S", 1e6 if by_reconnecting else 0.0)
    opened, outages = lab.open_study, []

    def away_once():
        if lab.sent("SubmitRegistration") and not outages:
            outages.append("server")
            raise StudyUnreachableError("The study cannot be reached now.")
        return opened()

    lab.open_study = away_once
    lab.receive(make_record(TRIAL))
    lab.run_until(lambda: lab.problems)
    assert "cannot be reached now" in lab.problems[0]
    assert lab.stored().true_tre_mm is None
    if by_reconnecting:
        lab.link.disconnect()
        lab.connect()
    else:
        lab.simulator.send(DeviceName.SIM_STATE, String('{"phase": "idle"}'))
    lab.run_until(lambda: lab.scored)
    stored = lab.stored()
    assert stored.score is not None
    assert stored.true_tre_mm is not None


def test_unacknowledged_scores_are_sent_once_each_though_the_link_opens_again(lab, make_record):
    trials = [str(uuid.UUID(int=number)) for number in (11, 12)]
    lab.refusal = "Not now."
    for trial in trials:
        lab.receive(make_record(trial, seed=SEED))
    lab.run_until(lambda: len(lab.sent("SubmitRegistration")) == 2 and not lab.work.isBusy)
    lab.run_until(lambda: not any(map(lab.logic.isBeingScored, trials)))
    assert lab.logic.received == trials
    lab.refusal = None
    for _ in range(2):
        lab.link.opened.emit()
    lab.run_until(lambda: len(lab.scored) >= 2 and not lab.work.isBusy)
    lab.run_until(lambda: not any(map(lab.logic.isBeingScored, trials)))
    assert sorted(arguments["trialId"] for arguments in lab.sent("TrialScored")) == trials
    assert sorted(trial.record.trial_id for trial in lab.scored) == trials


def test_an_old_trial_does_not_disturb_the_one_being_played(lab, make_record):
    states = []
    lab.link.stateChanged.connect(states.append)
    state = f'{{"trialId": "{OTHER}", "phase": "running"}}'
    lab.simulator.send(DeviceName.SIM_STATE, String(state))
    lab.run_until(lambda: states)
    lab.receive(make_record(TRIAL))
    lab.run_until(lambda: lab.scored)
    assert Role.WORLD_TO_HEAD.find(lab.scene) is None
    assert lab.stored().true_tre_mm is not None


def test_a_trial_deleted_with_its_trainee_is_acknowledged_and_not_stored_again(lab, make_record):
    lab.receive(make_record(TRIAL))
    lab.run_until(lambda: lab.scored)
    lab.in_study(lambda study: study.delete_trainee("T-001"))
    lab.receive(make_record(TRIAL))
    lab.run_until(lambda: len(lab.sent("AcknowledgeTrial")) == 2)
    assert lab.in_study(Study.trainees) == ()
    assert lab.problems == []
    assert len(lab.scored) == 1


def test_an_invalid_trial_is_refused_and_not_even_registered(lab, make_record, reviews):
    lab.receive(make_record(TRIAL))
    lab.run_until(lambda: lab.scored)
    for changes, message in (
        ({"trial_id": OTHER, "points": []}, "points must be"),
        ({"trial_id": []}, "trialId must be"),
        ({"trial_id": OTHER, "trainee": "T-001 "}, "A pseudonym must be printable text"),
        ({"trial_id": TRIAL, "task": "task-2"}, "Another trial is stored under the UUID"),
    ):
        lab.receive(make_record(**changes))
        lab.run_until(lambda message=message: lab.problems and message in lab.problems[-1])
    assert len(lab.all_sent("AcknowledgeTrial")) == 1
    # The valid one: once to register it, once with its truth.
    assert len(reviews) == 2
    assert [trainee.pseudonym for trainee in lab.in_study(Study.trainees)] == ["T-001"]


def test_a_flood_of_forged_trials_waits_in_a_short_queue_and_the_excess_is_reported(
    lab, make_record, monkeypatch
):
    waiting = 3
    monkeypatch.setattr(trial_logic, "MAX_WAITING", waiting)
    lab.logic.trialKept.connect(lambda _record: kept.append(True))
    kept = []
    for number in range(2 * waiting):
        lab.link.trialCompleted.emit(make_record(str(uuid.UUID(int=100 + number))))
    assert lab.problems == [trial_logic.TOO_MANY]
    before = 0
    while len(kept) < waiting:
        lab.work.process()
        assert len(kept) - before <= 1
        before = len(kept)
    lab.receive(make_record(TRIAL))
    lab.run_until(lambda: {"trialId": TRIAL} in lab.sent("AcknowledgeTrial"))
    assert lab.count() == waiting + 1


def test_a_trial_stored_when_slicer_ends_is_acknowledged_and_counted_once_by_the_next(
    lab, make_record, monkeypatch
):
    monkeypatch.setattr(background_work, "CLOSING_S", 120.0)
    lab.link.trialCompleted.emit(make_record(TRIAL))
    lab.link.disconnect()
    lab.logic.close()
    lab.work.close()
    assert lab.stored().true_tre_mm is None
    assert not lab.sent("AcknowledgeTrial")
    lab.work = BackgroundWork()
    lab.start()
    lab.connect()
    lab.receive(make_record(TRIAL))
    lab.run_until(lambda: lab.scored and lab.sent("AcknowledgeTrial"))
    assert lab.count() == 1


def test_after_switching_studies_trials_go_into_the_new_one(lab, make_record, tmp_path):
    lab.receive(make_record(TRIAL))
    lab.run_until(lambda: lab.scored)
    lab.path = tmp_path / "another.db"
    lab.logic.forgetWaiting()
    lab.receive(make_record(OTHER))
    lab.run_until(lambda: len(lab.scored) == 2)
    assert lab.stored(OTHER).record.trial_id == OTHER


# Aborted trials


def offer(lab, record):
    lab.simulator.send_command("TrialAborted", record)


def acknowledged(lab):
    return [arguments["trialId"] for arguments in lab.sent("AcknowledgeTrial")]


def test_an_aborted_trial_is_stored_once_and_not_again_after_its_trainee_was_deleted(lab):
    for count in (1, 2):
        offer(lab, make_aborted())
        lab.run_until(lambda count=count: acknowledged(lab) == count * [ABORTED])
    (stored,) = lab.in_study(lambda study: study.aborted("T-001"))
    assert stored == lab.kept[0]
    lab.in_study(lambda study: study.delete_trainee("T-001"))
    offer(lab, make_aborted())
    lab.run_until(lambda: acknowledged(lab) == 3 * [ABORTED])
    assert lab.in_study(Study.trainees) == ()


def test_an_unstorable_or_invalid_aborted_trial_is_reported_once_and_not_acknowledged(lab):
    lab.is_study_broken = True
    for _ in range(3):
        lab.link.trialAborted.emit(make_aborted())
        lab.run_until(lambda: not lab.work.isBusy)
    lab.is_study_broken = False
    offer(lab, make_aborted(901, trainee=" "))
    offer(lab, make_aborted())
    lab.run_until(lambda: acknowledged(lab))
    assert "The disk is full" in lab.problems[0]
    assert len(lab.problems) == 2
    assert acknowledged(lab) == [ABORTED]


def test_aborted_trials_are_stored_before_anything_that_arrives_later(lab):
    """A repeat that was stored earlier would count without a reason."""
    for number in (1, 2, 3):
        lab.link.trialAborted.emit(make_aborted(number))

    found = []
    stored = lambda study: len(study.aborted("T-001"))  # noqa: E731
    lab.work.do(lambda: lab.in_study(stored), found.append)
    lab.run_until(lambda: found)
    assert found == [3]
