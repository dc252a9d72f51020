"""A button acts by its label when it was pressed, no matter what happens before its release."""

import uuid

import pytest
import slicer
from PySide6 import QtCore, QtTest

from rastrainer.sections.training_logic import LOADING
from rastrainer.slicer.link.link_status import LinkState
from Testing.slicer.simulator_double import connect_module, run_until_received
from Testing.slicer.told_module import ToldModule

LEFT = QtCore.Qt.MouseButton.LeftButton


def press_slowly(host, name, meanwhile):
    """Press a button, and release it only when something else has happened."""
    host.unfold(name)
    button = host.find(name)._qt
    assert button.isEnabled(), name
    QtTest.QTest.mousePress(button, LEFT)
    meanwhile()
    QtTest.QTest.mouseRelease(button, LEFT)
    host.process_events()


@pytest.fixture
def host(fresh_module):
    return fresh_module


class Trial(ToldModule):
    """Waits until the module knows what it is told."""

    def tell(self, phase, number=5):
        trial_id = str(uuid.UUID(int=number))
        super().tell(phase=phase, trialId=trial_id)
        training = self.host.widget.logic.session.training
        wanted = (phase, trial_id)
        self.host.wait_until(
            lambda: (training.status.phase, training.status.trialId) == wanted, "it knows"
        )

    @property
    def commands(self):
        names = [name for name, _arguments in self.simulator.commands]
        return [name for name in names if name in ("Pause", "Resume", "Abort", "StartTask")]


@pytest.fixture
def trial(host, simulator):
    return Trial(host, simulator)


@pytest.mark.parametrize("name", ["pauseButton", "nextStepButton"])
def test_pause_stays_pause_even_if_the_trainee_pauses_meanwhile(trial, name):
    trial.tell("running")
    press_slowly(trial.host, name, lambda: trial.tell("paused"))
    run_until_received(trial.host.widget.logic.session.link)
    assert trial.commands == ["Pause"]


def test_a_trial_that_begins_while_the_question_is_open_is_not_aborted(trial, monkeypatch):
    trial.tell("running")

    def begin_another(*_texts):
        trial.tell("idle", 5)
        trial.tell("running", 6)
        return True

    monkeypatch.setattr(slicer.util, "confirmYesNoDisplay", begin_another)
    trial.host.unfold("abortButton")
    trial.host.press("abortButton")
    assert "was not aborted" in trial.host.messages[-1].text
    run_until_received(trial.host.widget.logic.session.link)
    assert trial.commands == []


def test_connect_does_not_disconnect_a_link_that_was_started_meanwhile(host):
    link = host.widget.logic.session.link
    press_slowly(host, "connectButton", lambda: link.connectTo("127.0.0.1", 1))
    assert link.status.state is not LinkState.OFF


def test_cancel_does_not_restart_work_that_ended_meanwhile(host, monkeypatch):
    host.unfold("useHeadButton")
    model = host.scene.AddNewNodeByClass("vtkMRMLModelNode", "Mine")
    host.choose("headModelComboBox", model)
    begun, button = [], host.find("useHeadButton")._qt

    def use(_node, progress):
        begun.append(True)
        progress("Working", 0.5)
        QtTest.QTest.mousePress(button, LEFT)
        return model, []

    monkeypatch.setattr(host.widget.logic.session.scenario, "useHead", use)
    host.press("useHeadButton")
    QtTest.QTest.mouseRelease(button, LEFT)
    assert begun == [True]


def test_the_chosen_target_is_used_even_if_another_was_placed_meanwhile(host):
    host.unfold("planTargetComboBox")
    host.press("placeTargetButton")
    host.place(10.0, 20.0, 30.0)
    host.press("placeTargetButton")
    host.place(20.0, 20.0, 30.0)
    combo = host.find("planTargetComboBox")
    host.wait_until(lambda: combo.count == 2, "both targets are offered")
    node = host.find("planComboBox").currentNode()
    node.AddControlPoint(30.0, 20.0, 30.0)
    combo._qt.setCurrentIndex(0)
    combo._qt.activated.emit(0)
    assert (combo.count, combo.currentIndex) == (3, 0)


def test_a_consent_that_could_not_be_saved_is_not_shown_as_given(host, monkeypatch):
    host.press("createTraineeButton")
    host.unfold("consentCheckBox")

    def refuse(**_changes):
        from rastrainer.errors import InputError

        raise InputError("Another program has locked the study.")

    monkeypatch.setattr(host.widget.logic.session.trainees, "change", refuse)
    host.check("consentCheckBox")
    assert not host.find("consentCheckBox").checked


def test_a_failed_setup_does_not_start_a_simulator_after_the_next_one(host, tmp_path):
    host.find("wheelsPathLineEdit").currentPath = str(tmp_path)
    host.answer("not set up on this computer yet", "Ok")
    host.unfold("startSimulatorButton")
    host.press("startSimulatorButton")
    assert "There are no wheels" in host.messages[-1].text
    count = len(host.messages)
    host.widget.logic.session.simulator.setup.finished.emit("")
    assert len(host.messages) == count


STARTING = ("startTrialRunButton", "startTaskButton", "nextStepButton")


def test_the_buttons_that_start_trials_are_disabled_while_slicers_head_is_loaded(host, simulator):
    simulator.responder = lambda name, _arguments: None if name == "LoadScenario" else {}
    connect_module(host, simulator)
    host.check("newConsentCheckBox")
    host.press("createTraineeButton")
    host.wait_until(lambda: host.find("startTaskButton").enabled, "a trial can be started")
    host.press("loadScenarioButton")
    assert [host.find(name).enabled for name in STARTING] == [False] * 3
    assert {host.find(name).toolTip for name in STARTING} == {LOADING}
    assert host.text("nextStepText") == LOADING
