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


def test_choices_are_kept_across_a_restart_and_unusable_ones_are_forgotten(start, tmp_path):
    checked = {
        "windowCheckBox": False,
        "networkCheckBox": True,
        "tutorialCheckBox": False,
        "headColoredCheckBox": True,
        "slicesNextPointCheckBox": False,
        "slicesToolCheckBox": True,
        "slicesAlongCheckBox": False,
    }
    typed = {"hostLineEdit": "10.0.0.7", "indexLineEdit": "https://wheels.example.org/simple"}
    paths = {
        "studyPathLineEdit": str(tmp_path / "mine.db"),
        "wheelsPathLineEdit": str(tmp_path / "wheels"),
        "programPathLineEdit": str(tmp_path / "rastrainer"),
    }
    chosen = {
        "modeComboBox": "Headset",
        "scenarioComboBox": "A ball",
        "taskComboBox": "Task-2",
        "kindComboBox": "Affine",
    }
    host = start()
    with new_folder(tmp_path / "ball") as made:
        write_scenario(made, made_up_scenario(), ball_head())
    host.answer("Add a scenario", pack(tmp_path / "ball", tmp_path / "ball.zip"))
    host.press("importScenarioButton")
    host.choose("scenarioComboBox", "Colin27")
    for name, value in (*typed.items(), *paths.items(), ("portSpinBox", "18999")):
        host.type(name, value)
    for name, value in checked.items():
        host.check(name, value)
    for name, value in chosen.items():
        host.choose(name, value)
    kept = {each.key for each in vars(settings).values() if isinstance(each, Setting)}
    # An address needs a server: test_study_at_an_address.py has one.
    assert kept - {STUDY_ADDRESS.key} <= set(slicer.app.settings().allKeys())
    host = start()
    assert {name: host.find(name).checked for name in checked} == checked
    assert {name: host.text(name) for name in typed} == typed
    assert {name: host.find(name).currentPath for name in paths} == paths
    assert {name: host.find(name).currentText for name in chosen} == chosen
    assert host.find("portSpinBox").value == 18999
    assert host.widget.logic.session.registration.kind == "affine"
    slicer.app.settings().setValue(PORT.key, "a lot")
    slicer.app.settings().setValue("RASTrainer/Mode", "telepathy")
    slicer.app.settings().setValue(STUDY_ADDRESS.key, "postgresql://seat:secret@host/study")
    host = start()
    assert host.find("portSpinBox").value == PORT.usual
    assert host.find("modeComboBox").currentText == "Desktop screen"
    assert host.text("studyAddressLineEdit") == ""
    assert host.find("studyPathLineEdit").enabled
