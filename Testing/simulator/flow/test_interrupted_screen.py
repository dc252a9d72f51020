"""After a crash the trainee learns how much was saved, and decides how to go on."""

from __future__ import annotations

import pytest

from rastrainer.commands import CommandName, check_arguments
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.protocol import Phase
from rastrainer_simulator.core.interrupted_trial import find_interrupted
from rastrainer_simulator.loop.control_loop import ControlLoop
from Testing.simulator.flow.conftest import put_back
from Testing.simulator.flow.trainee import RATE_HZ, Keys, Trainee

SAID = (
    "P07, dieser Versuch wurde unterbrochen; 0 von 15 Punkten sind gesichert. Mach mit Punkt 1 "
    "weiter, wenn du bereit bist, oder brich ihn ab."
)


@pytest.fixture
def records(shared, tmp_path):
    """A folder with the trial of a simulator that has ended in the middle."""
    put_back(shared)
    folder = tmp_path / "records"
    with ControlLoop(shared, folder, rate_hz=RATE_HZ, speed=None) as loop:
        arguments = check_arguments("StartTask", {"task": "task-2", "trainee": "P07"})
        assert loop.submit(CommandName.START_TASK, arguments).result(120.0).ok
    return folder


@pytest.fixture
def back(shared, records, outside):
    """A trainee at the restarted simulator."""
    reading, interrupted = find_interrupted(records)
    shared.resume_trial(interrupted)
    with ControlLoop(shared, records, rate_hz=RATE_HZ, speed=None, interrupted=reading) as loop:
        presenter = outside.presenter(loop, language="de")
        trainee = Trainee(loop, presenter, Keys)
        yield trainee
        trainee.close()
        presenter.close()


def journal(records):
    (path,) = records.glob("*.journal")
    return read_journal(path)


def test_the_menu_says_what_was_kept_and_resuming_leads_to_the_next_point(back, records):
    back.until_menu("trial")
    assert SAID in [warning.text for warning in back.presenter.screen.warnings]
    back.choose("resume", None)
    assert back.state.training.phase is Phase.RUNNING
    assert "1" in back.presenter.screen.instruction.text
    assert journal(records).of_kind("continued")


def test_the_interrupted_trial_can_be_aborted_from_the_menu(back, records):
    back.until_menu("trial")
    back.choose("abort", "abort")
    back.choose("abort", "experiment")
    # The menu is there before the journal's last line is whole on the disk.
    back.until(lambda: journal(records).integrity is Integrity.INTACT, "the journal's end")
