"""A button acts by its label when it was pressed, no matter what happens before its release."""

import uuid

import pytest
import slicer
from PySide6 import QtCore, QtTest

from rastrainer.slicer.link.link_status import LinkState
from Testing.slicer.simulator_double import run_until_received
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
    """Waits until the module knows the news."""

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


def test_pause_stays_pause_even_if_the_trainee_pauses_meanwhile(trial):
    for count, name in enumerate(("pauseButton", "nextStepButton"), start=1):
        trial.tell("running")
        press_slowly(trial.host, name, lambda: trial.tell("paused"))
        run_until_received(trial.host.widget.logic.session.link)
        assert trial.commands == ["Pause"] * count


def test_a_trial_that_begins_while_the_question_is_open_is_not_aborted(trial, monkeypatch):
    trial.tell("running")

    def begin_another(*_texts):
        trial.tell("idle", 5)
        trial.tell("running", 6)
        return True

    monkeypatch.setattr(slicer.util, "confirmYesNoDisplay", begin_another)
    trial.host.press("abortButton")
    assert "was not aborted" in trial.host.messages[-1].text
    run_until_received(trial.host.widget.logic.session.link)
    assert trial.commands == []


def test_connect_does_not_disconnect_a_link_that_was_started_meanwhile(host):
    link = host.widget.logic.session.link
    press_slowly(host, "connectButton", lambda: link.connectTo("127.0.0.1", 1))
    assert link.status.state is not LinkState.OFF


def test_a_consent_that_could_not_be_saved_is_not_shown_as_given(host, monkeypatch):
    host.press("createTraineeButton")

    def refuse(**_changes):
        from rastrainer.errors import InputError

        raise InputError("Another program has locked the study.")

    monkeypatch.setattr(host.widget.logic.session.trainees, "change", refuse)
    host.check("consentCheckBox")
    assert not host.find("consentCheckBox").checked
