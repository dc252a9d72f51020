"""While the simulator loads a head, the module's buttons start no trial, and say why."""

from rastrainer.sections.training_logic import LOADING
from Testing.slicer.simulator_double import connect_module

STARTING = ("startTrialRunButton", "startTaskButton", "nextStepButton")


def test_the_buttons_that_start_trials_are_disabled_while_slicers_head_is_loaded(host, simulator):
    simulator.responder = lambda name, _arguments: None if name == "LoadScenario" else {}
    host.open()
    connect_module(host, simulator)
    host.check("newConsentCheckBox")
    host.press("createTraineeButton")
    host.wait_until(lambda: host.find("startTaskButton").enabled, "a trial can be started")
    host.press("loadScenarioButton")
    assert [host.find(name).enabled for name in STARTING] == [False] * 3
    assert {host.find(name).toolTip for name in STARTING} == {LOADING}
    assert host.text("nextStepText") == LOADING
