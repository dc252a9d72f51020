"""The user's choices in the panels are restored after Slicer was closed and started again."""

import pytest
import slicer

from rastrainer.scenario.library import pack
from rastrainer.scenario.writer import new_folder, write_scenario
from rastrainer.slicer import settings
from rastrainer.slicer.settings import PORT, STUDY_ADDRESS, Setting
from Testing.domain.scenario.made_up_scenario import ball_head, made_up_scenario

SECTIONS = ("setup", "simulator", "trainees", "scenario", "training", "registration", "procedure")


@pytest.fixture
def start(start_slicer):
    """Returns a function that starts Slicer again with all of this open."""

    def start():
        host = start_slicer(*SECTIONS)
        host.find("setupGroupBox").collapsed = False
        host.process_events()
        return host

    return start


def test_choices_are_kept_across_a_restart(start, tmp_path):
    host = start()
    host.type("hostLineEdit", "10.0.0.7")
    host.type("portSpinBox", "18999")
    host.check("windowCheckBox", False)
    host.check("networkCheckBox")
    host.check("tutorialCheckBox", False)
    host.choose("modeComboBox", "Headset")
    with new_folder(tmp_path / "ball") as made:
        write_scenario(made, made_up_scenario(), ball_head())
    host.answer("Add a scenario", pack(tmp_path / "ball", tmp_path / "ball.zip"))
    host.press("importScenarioButton")
    host.choose("scenarioComboBox", "Colin27")
    host.choose("scenarioComboBox", "A ball")
    host.choose("taskComboBox", "Task-2")
    host.choose("kindComboBox", "Affine")
    host.check("headColoredCheckBox")
    host.check("slicesNextPointCheckBox", False)
    host.check("slicesToolCheckBox")
    host.check("slicesAlongCheckBox", False)
    host.type("studyPathLineEdit", str(tmp_path / "mine.db"))
    host.type("wheelsPathLineEdit", str(tmp_path / "wheels"))
    host.type("programPathLineEdit", str(tmp_path / "rastrainer"))
    host.type("indexLineEdit", "https://wheels.example.org/simple")
    kept = {each.key for each in vars(settings).values() if isinstance(each, Setting)}
    # An address needs a server: test_study_at_an_address.py has one.
    assert kept - {STUDY_ADDRESS.key} <= set(slicer.app.settings().allKeys())
    host = start()
    assert host.text("hostLineEdit") == "10.0.0.7"
    assert host.find("portSpinBox").value == 18999
    assert not host.find("windowCheckBox").checked
    assert host.find("networkCheckBox").checked
    assert host.find("modeComboBox").currentText == "Headset"
    assert not host.find("tutorialCheckBox").checked
    assert host.find("scenarioComboBox").currentText == "A ball"
    assert host.find("taskComboBox").currentText == "Task-2"
    assert host.text("indexLineEdit") == "https://wheels.example.org/simple"
    assert host.find("kindComboBox").currentText == "Affine"
    assert host.widget.logic.session.registration.kind == "affine"
    assert host.find("headColoredCheckBox").checked
    assert not host.find("slicesNextPointCheckBox").checked
    assert host.find("slicesToolCheckBox").checked
    assert not host.find("slicesAlongCheckBox").checked
    assert host.find("studyPathLineEdit").currentPath == str(tmp_path / "mine.db")
    assert host.find("wheelsPathLineEdit").currentPath == str(tmp_path / "wheels")
    assert host.find("programPathLineEdit").currentPath == str(tmp_path / "rastrainer")


def test_unusable_settings_leave_the_defaults(start):
    host = start()
    slicer.app.settings().setValue(PORT.key, "a lot")
    slicer.app.settings().setValue("RASTrainer/Mode", "telepathy")
    slicer.app.settings().setValue(STUDY_ADDRESS.key, "postgresql://seat:secret@host/study")
    host = start()
    assert host.find("portSpinBox").value == PORT.usual
    assert host.find("modeComboBox").currentText == "Desktop screen"
    assert host.text("studyAddressLineEdit") == ""
    assert host.find("studyPathLineEdit").enabled
