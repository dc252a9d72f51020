"""An aborted trial is stored once and acknowledged when it is stored, as a finished one is."""

import pytest

from rastrainer.errors import InputError
from rastrainer.sections.trial_logic import MAX_WAITING, AbortedTrialLogic
from rastrainer.sections.trial_services import TrialServices
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer.study.database.study import Study
from rastrainer_headless.connector import headlessKit
from Testing.domain.trial.trial_records import make_aborted
from Testing.slicer.simulator_double import SimulatorDouble, run_logic_until

TRIAL = make_aborted()["trialId"]


class Lab:
    """A logic on a link to a simulator double."""

    def __init__(self, scene, folder):
        self.path = folder / "study.db"
        self.is_study_broken = False
        self.simulator = SimulatorDouble(lambda _name, _arguments: {})
        self.link = Link(scene, headlessKit)
        self.work = BackgroundWork()
        services = TrialServices(scene, self.link, None, self.open_study, self.work)
        self.logic = AbortedTrialLogic(services)
        self.kept, self.problems = [], []
        self.logic.kept.connect(self.kept.append)
        self.logic.problemFound.connect(self.problems.append)
        opened = []
        self.link.opened.connect(lambda: opened.append(True))
        self.link.connectTo(port=self.simulator.port)
        self.run_until(lambda: opened and not self.work.isBusy)

    def open_study(self):
        if self.is_study_broken:
            raise InputError("The disk is full.")
        return Study.open(self.path)

    def offer(self, record):
        self.simulator.send_command("TrialAborted", record)

    def acknowledged(self):
        sent = self.simulator.commands
        return [arguments["trialId"] for name, arguments in sent if name == "AcknowledgeTrial"]

    def run_until(self, condition):
        run_logic_until(self.link, self.work, condition)

    def close(self):
        self.link.disconnect()
        self.logic.close()
        self.work.close()
        self.simulator.close()


@pytest.fixture
def lab(scene, tmp_path):
    lab = Lab(scene, tmp_path)
    yield lab
    lab.close()


def test_an_aborted_trial_is_stored_before_it_is_acknowledged(lab):
    lab.offer(make_aborted())
    lab.run_until(lambda: lab.acknowledged() == [TRIAL])
    with Study.open(lab.path) as study:
        (stored,) = study.aborted("T-001")
    assert stored.record == lab.kept[0]


def test_delivering_twice_stores_once(lab):
    for count in range(1, 4):
        lab.offer(make_aborted())
        lab.run_until(lambda count=count: len(lab.acknowledged()) == count)
    with Study.open(lab.path) as study:
        assert len(study.aborted("T-001")) == 1


def test_an_unstorable_aborted_trial_is_reported_once_and_not_acknowledged(lab):
    lab.is_study_broken = True
    for _ in range(3):
        lab.link.trialAborted.emit(make_aborted())
        lab.run_until(lambda: not lab.work.isBusy)
    lab.is_study_broken = False
    lab.offer(make_aborted())
    lab.run_until(lambda: lab.acknowledged())
    assert lab.problems == ["An aborted trial could not be stored: The disk is full."]
    assert lab.acknowledged() == [TRIAL]


def test_aborted_trials_are_stored_before_anything_that_arrives_later(lab):
    """A repeat that was stored earlier would count without a reason."""
    for number in (1, 2, 3):
        lab.link.trialAborted.emit(make_aborted(number))

    def stored():
        with Study.open(lab.path) as study:
            return len(study.aborted("T-001"))

    found = []
    lab.work.do(stored, found.append)
    lab.run_until(lambda: found)
    assert found == [3]


@pytest.mark.parametrize(
    "hostile",
    [
        pytest.param({}, id="empty"),
        pytest.param(make_aborted(points=[{}] * 15), id="points"),
        pytest.param(make_aborted(elapsedS="long"), id="elapsed"),
        pytest.param(make_aborted(trainee=" "), id="trainee"),
    ],
)
def test_a_hostile_record_is_reported_and_later_ones_are_stored(lab, hostile):
    lab.offer(hostile)
    lab.run_until(lambda: lab.problems)
    lab.offer(make_aborted())
    lab.run_until(lambda: lab.acknowledged() == [TRIAL])
    assert len(lab.problems) == 1


def test_an_aborted_trial_of_a_deleted_trainee_is_acknowledged_and_not_stored(lab):
    lab.offer(make_aborted())
    lab.run_until(lambda: lab.acknowledged() == [TRIAL])
    with Study.open(lab.path) as study:
        study.delete_trainee("T-001")
    lab.offer(make_aborted())
    lab.run_until(lambda: lab.acknowledged() == [TRIAL, TRIAL])
    with Study.open(lab.path) as study:
        assert study.trainees() == ()


def test_aborted_trials_beyond_the_queue_limit_wait_for_the_next_offer(lab):
    offered = [make_aborted(number) for number in range(1, MAX_WAITING + 10)]
    for _ in range(2):
        for record in offered:
            lab.link.trialAborted.emit(record)
        lab.run_until(lambda: not lab.logic._waiting)
    lab.run_until(lambda: len(lab.kept) >= MAX_WAITING)
    with Study.open(lab.path) as study:
        assert MAX_WAITING <= len(study.aborted("T-001")) <= len(offered)
