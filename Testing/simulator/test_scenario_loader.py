"""LoadScenario: which folders may be named, and what is said when one cannot be used."""

from __future__ import annotations

from concurrent.futures import Future
from types import SimpleNamespace

import pytest

from rastrainer.errors import InputError
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.scenario_loader import ScenarioLoader
from rastrainer_simulator.state import Answer


class Loop:
    """Stands in for the control loop."""

    def __init__(self):
        self.answer = Answer(0, True)
        self.simulations = []

    def replace_simulation(self, simulation):
        self.simulations.append(simulation)
        future = Future()
        future.set_result(self.answer)
        return future


def simulation_of(folder):
    if not folder.is_dir():
        raise InputError(f"The scenario's folder {folder} does not exist.")
    scenario = SimpleNamespace(name=folder.name, title=folder.name.title())
    return SimpleNamespace(setup=SimpleNamespace(scenario=scenario), folder=folder)


@pytest.fixture
def make():
    """Makes loaders, and ends them."""
    loaders = []

    def make_one(loop, may_be_anywhere):
        loaders.append(ScenarioLoader(loop, simulation_of, may_be_anywhere))
        return loaders[-1]

    yield make_one
    for loader in loaders:
        loader.close()


@pytest.mark.parametrize("may_be_anywhere", [True, False])
def test_scenario_that_comes_with_us_is_loaded_by_its_name(make, may_be_anywhere):
    loop = Loop()
    answer = make(loop, may_be_anywhere).load("colin27").result(10)
    assert (answer.ok, answer.data) == (True, {"name": "colin27", "title": "Colin27"})
    assert loop.simulations[0].folder == asset_path("scenarios", "colin27")


def test_any_folder_may_be_loaded_by_its_path_on_one_computer(make, tmp_path):
    assert make(Loop(), may_be_anywhere=True).load(str(tmp_path)).result(10).ok


@pytest.mark.parametrize("folder", ["/etc", "../colin27", "colin27/..", "."])
def test_client_of_another_computer_reaches_no_other_folder(make, folder):
    loop = Loop()
    answer = make(loop, may_be_anywhere=False).load(folder).result(10)
    assert not answer.ok
    assert "LoadScenario takes one of colin27" in answer.message
    assert loop.simulations == []


def test_folder_that_cannot_be_used_is_refused_in_one_sentence(make, tmp_path):
    answer = make(Loop(), may_be_anywhere=True).load(str(tmp_path / "none")).result(10)
    assert (answer.ok, "does not exist" in answer.message) == (False, True)


def test_refusal_of_the_control_loop_is_passed_on(make):
    loop = Loop()
    loop.answer = Answer(0, False, "A trial is running.")
    assert make(loop, may_be_anywhere=True).load("colin27").result(10) == loop.answer


def test_the_present_scenario_is_made_anew_wherever_it_came_from(make, tmp_path):
    loop = Loop()
    loop.setup = SimpleNamespace(scenario=SimpleNamespace(folder=tmp_path))
    assert make(loop, may_be_anywhere=False).reload().result(10).ok
    assert loop.simulations[0].folder == tmp_path
