"""Journals are read by a process of Slicer's Python, never by Slicer's own."""

import os
import sys
import uuid
from pathlib import Path

import pytest
import slicer

from Testing.running_process import runs
from Testing.slicer.host.cancels import cancels
from Testing.slicer.host.host import Host
from Testing.slicer.host.opened_journals import OpenedJournals
from Testing.slicer.recorded_trial import store_trial_on_colin, write_recorded_trial
from Testing.slicer.simulator_double import wait_until

pytestmark = [
    pytest.mark.skipif(
        not sys.platform.startswith("linux"),
        reason="the launcher's double is a script, FIFOs block",
    ),
    pytest.mark.usefixtures("own_processes"),
]
TRIAL = str(uuid.UUID(int=1))
REPLAY = "Replay of T-001, task-1"


@pytest.fixture
def journals(panel):  # noqa: ARG001 (Slicer runs)
    """The processes that have opened journals."""
    opened = OpenedJournals(Path(slicer.app.slicerHome))
    yield opened
    opened.close()


@pytest.fixture
def panel(host, make_record):
    """The section Score, with a stored trial; no trainee is chosen."""
    return open_score(host, make_record(TRIAL, scenario="colin27"))


def open_score(host, record):
    host.open()
    host.unfold("feedbackText")
    store_trial_on_colin(host, record, 3)
    host.press("createTraineeButton")
    return host


@pytest.fixture
def records():
    """Where the module looks for the journals of its simulator."""
    return Path.home() / "RASTrainer" / "trials"


def choose_trial(panel):
    panel.choose("traineeComboBox", "T-001")


def wait_for_feedback(panel):
    panel.wait_until(
        lambda: panel.text("feedbackText").startswith("Score "), "the feedback is shown"
    )


def endless_journal(folder):
    """Make a journal that never yields anything: a process that opens it waits for a writer."""
    folder.mkdir(parents=True)
    os.mkfifo(folder / f"20260302T090000Z_{TRIAL}.journal")


def test_feedback_and_replay_read_the_journal_in_another_process(panel, records, journals):
    write_recorded_trial(records, TRIAL, 16.0)
    choose_trial(panel)
    wait_for_feedback(panel)
    panel.press("replayButton")
    assert panel.scene.GetFirstNodeByName(REPLAY).GetNumberOfItems() > 150
    pids = journals.pids()
    assert len(set(pids)) == 2
    assert os.getpid() not in pids
    assert not any(map(runs, pids))
    # A replay in the scene is not read again.
    panel.press("worstTouchButton")
    assert journals.pids() == pids
    panel.wait_until(lambda: "clearance" in panel.text("replayText"), "it is described")


def test_cancel_ends_the_process_that_reads_the_journal(panel, records, journals):
    choose_trial(panel)
    wait_for_feedback(panel)
    panel.press("replayButton")
    assert "only on the computer whose simulator recorded it" in panel.messages[-1].text
    endless_journal(records)
    with cancels(panel, "replayButton", journals.pids):
        panel.press("replayButton")
    (pid,) = journals.pids()
    assert panel.scene.GetFirstNodeByName(REPLAY) is None
    assert panel.text("replayButton") == "Show the trial again"
    wait_until(lambda: not runs(pid), panel.process_events)


def test_closing_slicer_ends_the_process_that_reads_the_journal(tmp_path, make_record):
    host = Host(tmp_path / "slicer")
    journals = OpenedJournals(tmp_path / "slicer" / "Slicer")
    try:
        endless_journal(Path.home() / "RASTrainer" / "trials")
        choose_trial(open_score(host, make_record(TRIAL, scenario="colin27")))
        host.wait_until(journals.pids, "the journal is opened")
        (pid,) = journals.pids()
    finally:
        journals.close()
        host.close()
    wait_until(lambda: not runs(pid), lambda: None)
