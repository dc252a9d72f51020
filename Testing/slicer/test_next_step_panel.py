"""The line at the top: its texts, and which sections it opens and folds."""

import pytest
from PySide6 import QtCore, QtTest

from Testing.slicer.told_module import ToldModule


class Instructor(ToldModule):
    """Looks at the button and at the sections."""

    def wait_for(self, title):
        self.host.wait_until(
            lambda: self.host.text("nextStepButton") == title, f"the button says {title}"
        )

    def open_sections(self):
        end = "CollapsibleButton"
        names = [name for name in vars(self.host.widget.ui) if name.endswith(end)]
        return {name.removesuffix(end) for name in names if not self.host.find(name).collapsed}


@pytest.fixture
def host(fresh_module):
    return fresh_module


@pytest.fixture
def instructor(host, simulator):
    return Instructor(host, simulator)


def test_a_section_opens_when_its_step_comes_and_folds_after_it(instructor):
    assert instructor.open_sections() == {"trainees"}
    # Sections without a step are left to the user.
    instructor.host.unfold("taskComboBox")
    instructor.host.press("nextStepButton")
    assert instructor.open_sections() == {"training", "scenario"}
    instructor.host.find("scenarioCollapsibleButton").collapsed = True
    instructor.tell(phase="complete")
    instructor.wait_for("Waiting…")
    assert instructor.open_sections() == {"registration"}
    with pytest.raises(AssertionError, match="the trainee registers them"):
        instructor.host.press("nextStepButton")


def test_sections_the_user_opens_or_folds_stay_so_until_the_next_step(instructor):
    host = instructor.host
    host.press("createTraineeButton")
    instructor.wait_for("Start the trial run")
    host.unfold("residualsTable")
    host.find("trainingCollapsibleButton").collapsed = True
    instructor.tell(phase="running")
    instructor.wait_for("Pause")
    instructor.tell(phase="paused")
    instructor.wait_for("Resume")
    assert instructor.open_sections() == {"registration"}
    instructor.tell(phase="idle", trialId="")
    host.choose("traineeComboBox", "Choose a trainee")
    instructor.wait_for("Choose a trainee")
    assert instructor.open_sections() == {"trainees"}
    # The button opens the list of trainees.
    host.find("traineesCollapsibleButton").collapsed = True
    host.press("nextStepButton")
    assert instructor.open_sections() >= {"trainees"}
    host.choose("traineeComboBox", "T001")
    instructor.wait_for("Start the trial run")


def test_the_trial_run_waits_for_the_tutorial_unless_the_instructor_unchecks_it(instructor):
    host, simulator = instructor.host, instructor.simulator
    simulator.responder = lambda name, _arguments: {"isNeeded": name == "StartTutorial"}
    host.press("createTraineeButton")
    instructor.wait_for("Start the trial run")
    host.press("nextStepButton")
    host.wait_until(lambda: "tutorial first" in host.text("nextStepText"), "it says so")
    assert "StartTask" not in [name for name, _arguments in simulator.commands]
    host.check("tutorialCheckBox", False)
    host.press("nextStepButton")
    host.wait_until(
        lambda: "StartTask" in [name for name, _ in simulator.commands], "the trial run is started"
    )


def test_the_same_button_starts_or_connects_to_a_simulator_on_another_computer(host):
    assert host.text("linkText") == "Not connected"
    assert host.text("nowTraineeText") == "No trainee"
    assert host.text("nextStepButton") == "Start and connect"
    assert host.find("nextStepButton").enabled
    host.type("hostLineEdit", "localhost.localdomain")
    host.wait_until(lambda: host.text("nextStepButton") == "Connect", "the button follows")
    host.press("nextStepButton")
    host.wait_until(lambda: host.text("linkText") != "Not connected", "the module searches for it")


def test_the_button_can_be_reached_by_keyboard(host):
    button = host.find("nextStepButton")._qt
    button.window().activateWindow()
    host.wait_until(button.window().isActiveWindow, "the window is active")
    button.window().setFocus()
    QtTest.QTest.keyClick(button.window(), QtCore.Qt.Key.Key_Tab)
    assert button.hasFocus()
    host.answer("not set up on this computer yet", "Cancel")
    QtTest.QTest.keyClick(
        button, QtCore.Qt.Key.Key_Return, QtCore.Qt.KeyboardModifier.ControlModifier
    )
    host.wait_until(lambda: host.messages, "the shortcut asks whether to set up")
