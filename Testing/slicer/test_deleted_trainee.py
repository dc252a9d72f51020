"""A trainee is deleted in a thread, and the deletion may be canceled until it has begun."""

import threading
import uuid
from pathlib import Path

import pytest
from PySide6 import QtCore

from rastrainer.study import trainee_data
from rastrainer.study.database.study import Study
from Testing.slicer.host.cancels import cancels
from Testing.slicer.recorded_trial import write_recorded_trial

NAME = "T-001"


@pytest.fixture
def panel(fresh_module):
    """The section Trainees, with a chosen trainee."""
    fresh_module.type("pseudonymLineEdit", NAME)
    fresh_module.press("createTraineeButton")
    return fresh_module


@pytest.fixture
def journal():
    """The journal of a trial that the trainee did not finish."""
    folder = Path.home() / "RASTrainer" / "trials"
    write_recorded_trial(folder, str(uuid.UUID(int=1)), 1.0, NAME)
    (path,) = folder.glob("*.journal")
    return path


def stored(panel):
    with Study.open(panel.find("studyPathLineEdit").currentPath) as study:
        return [trainee.pseudonym for trainee in study.trainees()]


def test_a_deletion_that_has_not_begun_is_canceled(panel, journal, monkeypatch):
    trainees, may_open, left = panel.widget.logic.session.trainees, threading.Event(), []
    open_patiently = trainees._openPatiently

    def open_late():
        left.append(threading.current_thread())
        assert may_open.wait(60.0)
        return open_patiently()

    monkeypatch.setattr(trainees, "_openPatiently", open_late)
    panel.answer("cannot be undone", "Yes")
    with cancels(panel, "deleteTraineeButton", lambda: left):
        panel.press("deleteTraineeButton")
    may_open.set()
    left[0].join(60.0)
    assert "nothing has changed" in panel.text("traineeText")
    assert (journal.exists(), stored(panel)) == (True, [NAME])
    assert panel.text("deleteTraineeButton") == "Delete…"


def test_a_deletion_that_has_begun_continues_and_says_so(panel, journal, monkeypatch):
    may_go_on = threading.Event()
    erase_journals, received = trainee_data.erase_journals, []

    def erase(*values):
        assert threading.current_thread() is not threading.main_thread()
        assert may_go_on.wait(60.0)
        return erase_journals(*values)

    def look():
        button = panel.find("deleteTraineeButton")
        if panel.text("traineeText") == f"Deleting {NAME}":
            received.append((button.enabled, button.toolTip))
            panel.widget.logic.session.trainees.changed.emit()
            received.append((button.enabled, button.toolTip))
            may_go_on.set()

    monkeypatch.setattr(trainee_data, "erase_journals", erase)
    panel.answer("cannot be undone", "Yes")
    timer = QtCore.QTimer()
    timer.timeout.connect(look)
    timer.start(5)
    panel.press("deleteTraineeButton")
    timer.stop()
    assert {enabled for enabled, _tip in received} == {False}
    assert "can no longer be canceled" in received[-1][1]
    assert "was deleted with 0 trials and 1 journals" in panel.text("traineeText")
    assert (journal.exists(), stored(panel)) == (False, [])
