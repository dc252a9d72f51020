"""While the simulator loads a head, the module's buttons start no trial, and say why."""

import pytest

from rastrainer.sections.training_logic import LOADING
from Testing.slicer.simulator_double import SimulatorDouble, connect_module
from Testing.slicer.training_room import LOADING_REFUSAL

STARTING = ("startTrialRunButton", "startTaskButton", "nextStepButton")


class Simulator:
    """Answers as a simulator that loads a head, for the module or for another client."""

    def __init__(self):
        self.is_loading = False

    def answer(self, name, _arguments):
        if name == "LoadScenario":
            self.is_loading = True
            return None
        if name == "StartTask" and self.is_loading:
            return LOADING_REFUSAL
        return {"isNeeded": False} if name == "StartTutorial" else {}


@pytest.fixture
def simulator():
    return Simulator()


@pytest.fixture
def module(host, simulator):
    """The module, connected, with a trainee."""
    host.open()
    with SimulatorDouble(simulator.answer) as double:
        connect_module(host, double)
        host.unfold("createTraineeButton")
        host.check("newConsentCheckBox")
        host.press("createTraineeButton")
        host.wait_until(lambda: host.find("startTaskButton").enabled, "a trial can be started")
        yield host


def test_the_buttons_that_start_trials_are_disabled_while_slicers_head_is_loaded(module):
    assert all(module.find(name).enabled for name in STARTING)
    module.unfold("loadScenarioButton")
    module.press("loadScenarioButton")
    assert [module.find(name).enabled for name in STARTING] == [False] * 3
    assert {module.find(name).toolTip for name in STARTING} == {LOADING}
    assert module.text("nextStepText") == LOADING


def test_the_simulators_refusal_is_shown_while_another_client_is_loading_a_head(module, simulator):
    simulator.is_loading = True
    module.unfold("startTaskButton")
    module.press("startTaskButton")
    module.wait_until(lambda: module.text("trainingMessageText") == LOADING_REFUSAL, "the reason")
    assert module.find("startTaskButton").enabled
    simulator.is_loading = False
    module.press("startTaskButton")
    module.wait_until(lambda: module.text("trainingMessageText") == "", "it is accepted")
