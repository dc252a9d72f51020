"""The section Registration follows the trial that is shown: its touches, its task's fiducials."""

import uuid
from pathlib import Path

import pytest

from rastrainer.registration.registration import register
from rastrainer.slicer.scene.nodes import Role
from rastrainer.study.outcomes import task_title
from Testing.slicer.recorded_trial import COLIN27, store_trial_on_colin, write_recorded_trial
from Testing.slicer.told_module import ToldModule

TASKS = ("task-1", "task-2")


@pytest.fixture
def trials(host, make_record):
    """The module with a recorded trial of each of two tasks; their own FRE, mm, by task."""
    host.open()
    fre = {}
    for number, task in enumerate(TASKS, start=1):
        trial_id, started = str(uuid.UUID(int=number)), f"2026-03-02T09:0{number}:00Z"
        record = make_record(trial_id, trainee="T001", task=task, startedUtc=started)
        touched = store_trial_on_colin(host, record, number)
        fre[task] = register(touched, COLIN27.task(task).fiducials).fre_mm
        write_recorded_trial(Path.home() / "RASTrainer" / "trials", trial_id)
    host.press("createTraineeButton")
    host.choose("traineeComboBox", "T001")
    return fre


def replay(host, trials, number, task):
    """Replay a trial and wait until its own touches are registered."""
    host.choose("trialComboBox", f"{number}: {task_title(task)}")
    host.press("replayButton")
    expected = pytest.approx(trials[task], abs=0.01)
    host.wait_until(lambda: shown_fre(host) == expected, f"the touches of {task} are registered")
    assert host.find("residualsTable").rowCount == 15


def shown_fre(host):
    shown = host.find("fitsTable").item(0, 1)
    return None if shown is None else float(shown.text())


def test_a_replay_registers_all_its_touches_and_to_its_own_tasks_fiducials(host, trials):
    replay(host, trials, 1, "task-1")
    host.choose("residualsTable", 3)
    host.press("excludeButton")
    host.finish_work()
    assert host.find("residualsTable").rowCount == 14
    replay(host, trials, 2, "task-2")
    # They are not paired with another task's fiducials.
    host.choose("taskComboBox", "Task 1")
    host.press("showScenarioButton")
    host.wait_until(
        lambda: "show the task" in host.text("registrationText"), "the message is shown"
    )
    assert host.find("fitsTable").item(0, 1) is None
    host.choose("taskComboBox", "Task 2")
    host.press("showScenarioButton")
    host.wait_until(lambda: host.find("residualsTable").rowCount == 15, "they are registered")


def test_a_trial_in_progress_is_not_disturbed_and_begins_without_the_replays_touches(
    host, trials, simulator
):
    replay(host, trials, 1, "task-1")
    tasks = {"scenario": "colin27", "title": "Colin", "tasks": []}
    simulator.responder = lambda name, _arguments: tasks if name == "ListTasks" else {}
    told = ToldModule(host, simulator)
    told.tell(task="task-2")
    captured = Role.CAPTURED_POINTS.make(host.scene)
    host.wait_until(lambda: captured.GetNumberOfControlPoints() == 0, "the trial begins")
    assert captured.GetDisplayNode().GetVisibility()
    host.press("replayButton")
    assert "A trial is in progress" in host.messages[-1].text
    host.press("connectButton")
    host.press("replayButton")
    assert len(host.messages) == 1
