"""The section Procedure leads from the registration to the release, and shows the errors."""

import json
import uuid
from dataclasses import replace

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.igtl.content import String
from rastrainer.procedure.errors import analyze_procedure
from rastrainer.protocol import DeviceName
from rastrainer.slicer.settings import SLICES_LIE_ALONG
from rastrainer.trial.procedure_outcome import ProcedureMeasures, ProcedureOutcome, score_procedure
from Testing.domain.procedure.made_up_procedure import made_up_meshes, made_up_procedure
from Testing.domain.procedure.procedure_records import recorded
from Testing.slicer.simulator_double import SimulatorDouble, connect_module

TRIAL = str(uuid.UUID(int=21))
STATE = {"trialId": TRIAL, "trainee": "T001", "task": "task-1", "mode": "desktop"}
BUTTONS = {
    "verifying": {"acceptButton": "AcceptRegistration", "registerAgainButton": "RegisterAgain"},
    "aligning": {"alignButton": "AlignGuide", "lockButton": "LockGuide"},
    "drilling": {
        "advanceButton": "Feed",
        "withdrawButton": "Feed",
        "retractDrillButton": "RetractDrill",
        "startInsertionButton": "StartInsertion",
    },
    "inserting": {
        "advanceButton": "Feed",
        "withdrawButton": "Feed",
        "releaseButton": "ReleaseInstrument",
    },
}
ALL = sorted({name for buttons in BUTTONS.values() for name in buttons})


@pytest.fixture
def surgery(fresh_module):
    """The module, connected, with a trainee and a scenario that has procedures."""
    host = fresh_module
    with SimulatorDouble(lambda _name, _arguments: {"scenario": "colin27"}) as simulator:
        connect_module(host, simulator)
        host.press("createTraineeButton")
        host.find("procedureCollapsibleButton").collapsed = False
        yield host, simulator


def tell(host, simulator, phase, **procedure):
    """Have the simulator report the progress of the procedure, and wait until it is shown."""
    values = {"name": "seeg", "trajectory": 1, "trajectories": 5, "registrationInUse": True}
    state = {**STATE, "phase": phase, "procedure": {**values, **procedure}}
    logic = host.widget.logic.session.procedure
    before = logic.status
    simulator.send(DeviceName.SIM_STATE, String(json.dumps(state)))
    host.wait_until(lambda: logic.status != before, "the state has arrived")
    assert logic.status.phase == phase


def sent(simulator, name):
    return [arguments for command, arguments in simulator.commands if command == name]


def test_method_and_procedure_are_chosen_beside_the_task_as_far_as_the_head_allows(surgery):
    host, simulator = surgery
    assert host.find("methodComboBox").currentText == "Fiducials"
    host.choose("procedureComboBox", "Stereo-EEG of the right hemisphere")
    for count, method in enumerate(("Trace over the skin", "Fiducials"), start=1):
        host.choose("methodComboBox", method)
        host.press("startTaskButton")
        host.wait_until(
            lambda count=count: len(sent(simulator, "StartTask")) == count, "the task is started"
        )
    traced, touched = sent(simulator, "StartTask")
    assert (traced["method"], traced["procedure"]) == ("surface", "seeg")
    assert "method" not in touched
    session = host.widget.logic.session
    head = replace(session.scenarios.find("colin27"), landmarks=())
    host.choose("methodComboBox", "Landmarks of the face")
    session.chooseTask(head.task("task-1"), head)
    box = host.find("methodComboBox")
    assert (box.count, box.enabled, box.currentText) == (1, False, "Fiducials")
    assert "has no landmarks" in box.toolTip


def test_each_phase_offers_its_steps_and_says_what_comes_next(surgery):
    host, simulator = surgery
    simulator.responder = lambda name, _arguments: None if name == "ListTasks" else {}
    tell(host, simulator, "verifying", registrationInUse=False)
    assert host.text("procedureInstructionText") == "The touches are being registered."
    assert not host.find("acceptButton").enabled
    words = {
        "verifying": ({"lastCheckMm": 1.26}, "The last checkpoint was 1.3 mm off."),
        "aligning": (
            {"entryDistanceMm": 0.312, "angleDeg": 0.2, "standOffMm": 25.0},
            "seeg, line 2 of 5: the guide is 0.31 mm and 0.20° off, 25.0 mm before the entry.",
        ),
        "drilling": ({"feedMm": 31.44}, "seeg, line 2 of 5: 31.4 mm beyond the guide."),
        "inserting": ({"feedMm": 7.0}, "seeg, line 2 of 5: 7.0 mm beyond the guide."),
    }
    for phase, buttons in BUTTONS.items():
        values, sentence = words[phase]
        tell(host, simulator, phase, **values)
        text = host.text("procedureStateText") + " " + host.text("procedureInstructionText")
        assert sentence in text
        assert [name for name in ALL if host.find(name).enabled] == sorted(buttons)
        for button, command in buttons.items():
            before = len(sent(simulator, command))
            host.press(button)
            host.wait_until(
                lambda command=command, before=before: len(sent(simulator, command)) > before,
                f"{command} is sent",
            )
    moved = [each["velocityMmS"] * each["durationS"] for each in sent(simulator, "Feed")]
    assert moved == [1.0, -1.0, 1.0, -1.0]
    assert "while the registration is verified" in host.find("acceptButton").toolTip


def test_the_errors_are_shown_with_the_shares_of_registration_and_hand(fresh_module):
    host = fresh_module
    session = host.widget.logic.session
    procedure = made_up_procedure()
    off = transforms.rigid(np.eye(3), np.array([0.0, 1.5, 0.0]))
    done = recorded(procedure, off)
    analysis = analyze_procedure(done, procedure, made_up_meshes(), np.eye(4))
    session.procedure.outcome = ProcedureOutcome(
        analysis, score_procedure(ProcedureMeasures.of(analysis, procedure), 300.0)
    )
    session.procedure.outcomeChanged.emit()
    host.unfold("procedureErrorsTable")
    table = host.find("procedureErrorsTable")
    assert [table.item(0, column).text() for column in range(4)] == ["Left", "1.50", "1.50", "0.00"]
    assert host.text("procedureScoreText").startswith("Score of the procedure: ")
    host.choose("procedureErrorsTable", 1)
    red = host.scene.GetNodeByID("vtkMRMLSliceNodeRed").GetSliceToRAS()
    assert red.GetElement(2, 3) == pytest.approx(procedure.trajectories[1].target_ras[2])
    host.check("slicesAlongCheckBox", False)
    assert not session.settings.get(SLICES_LIE_ALONG)
