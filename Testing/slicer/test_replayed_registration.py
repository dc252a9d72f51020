"""The section Registration follows the trial that is shown: its touches, its task's fiducials."""

import json
import uuid
from pathlib import Path

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.igtl.content import String
from rastrainer.protocol import DeviceName
from rastrainer.scenario.scenario import load_scenario
from rastrainer.slicer.scene.nodes import capturedPointsNode
from rastrainer.study.database.study import Study
from rastrainer.study.outcomes import task_title
from rastrainer_simulator.assets import asset_path
from Testing.slicer.recorded_trial import scored_analysis, write_recorded_trial
from Testing.slicer.simulator_double import SimulatorDouble

TASKS = ("task-1", "task-2")


@pytest.fixture
def trials(host, make_record):
    """The module with a recorded trial of each of two tasks; their own FRE, mm, by task."""
    host.open()
    colin = load_scenario(asset_path("scenarios", "colin27"))
    fre = {}
    for number, task in enumerate(TASKS, start=1):
        record = make_record(
            str(uuid.UUID(int=number)),
            trainee="T001",
            task=task,
            scenario="colin27",
            startedUtc=f"2026-03-02T09:0{number}:00Z",
        )
        noise = np.random.default_rng(number).normal(0.0, 0.6, (15, 3))
        head = colin.perturbed_head_to_world(number)
        touched = transforms.apply(head, colin.task(task).fiducials + noise)
        for point, position in zip(record["points"], touched.tolist(), strict=True):
            point["positionMm"] = position
        analysis = scored_analysis(record, colin)
        fre[task] = analysis.rigid.fre_mm
        with Study.open(host.find("studyPathLineEdit").currentPath) as study:
            study.add_trial(record, analysis.fits.values(), analysis.target_errors, analysis.score)
        write_recorded_trial(Path.home() / "RASTrainer" / "trials", record["trialId"])
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


def test_a_trial_in_progress_is_not_disturbed_and_begins_without_the_replays_touches(host, trials):
    replay(host, trials, 1, "task-1")
    tasks = {"scenario": "colin27", "title": "Colin", "tasks": []}
    answers = {"ListTasks": tasks}
    with SimulatorDouble(lambda name, _arguments: answers.get(name, {})) as simulator:
        host.type("portSpinBox", str(simulator.port))
        host.press("connectButton")
        host.wait_until(lambda: simulator.commands, "the module sends its greeting")
        state = {"trialId": str(uuid.UUID(int=9)), "phase": "running", "task": "task-2"}
        simulator.send(DeviceName.SIM_STATE, String(json.dumps({**state, "trainee": "T001"})))
        captured = capturedPointsNode(host.scene)
        host.wait_until(lambda: captured.GetNumberOfControlPoints() == 0, "the trial begins")
        assert captured.GetDisplayNode().GetVisibility()
        host.press("replayButton")
        assert "A trial is in progress" in host.messages[-1].text
        host.press("connectButton")
        host.press("replayButton")
        assert len(host.messages) == 1
