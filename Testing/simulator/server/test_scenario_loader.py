"""LoadScenario: which folders may be named, and the error if one cannot be used."""

from concurrent.futures import Future
from types import SimpleNamespace

import pytest

from rastrainer.errors import InputError
from rastrainer.scenario.writer import new_folder, write_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.authoring import procedure_plan
from rastrainer_simulator.loop.control_loop import BEING_SET_UP, TRIAL_IS_OPEN
from rastrainer_simulator.server.scenario_loader import FAILED, ScenarioLoader
from rastrainer_simulator.state import Answer
from Testing.domain.scenario.made_up_scenario import ball_head, made_up_scenario, png


class Loop:
    """Stands in for the control loop."""

    def __init__(self):
        self.answer = Answer(0, True)
        self.is_trial_open = False
        self.is_being_replaced = False
        self.simulations = []

    def begin_replacement(self):
        assert not self.is_being_replaced
        self.is_being_replaced = not self.is_trial_open
        return answered(Answer(0, False, TRIAL_IS_OPEN) if self.is_trial_open else Answer(0, True))

    def replace_simulation(self, simulation):
        assert self.is_being_replaced
        self.simulations.append(simulation)
        return answered(self.answer)

    def end_replacement(self):
        assert self.is_being_replaced
        self.is_being_replaced = False


def answered(answer):
    future = Future()
    future.set_result(answer)
    return future


def simulation_of(folder):
    if not folder.is_dir():
        raise InputError(f"The scenario's folder {folder} does not exist.")
    scenario = SimpleNamespace(name=folder.name, title=folder.name.title(), procedures=())
    return SimpleNamespace(setup=SimpleNamespace(scenario=scenario), folder=folder)


@pytest.fixture
def library(tmp_path):
    """A user's library with a good and a broken scenario."""
    ball = tmp_path / "library" / "ball"
    (tmp_path / "library" / "broken").mkdir(parents=True)
    (tmp_path / "library" / "broken" / "scenario.json").write_text("{")
    with new_folder(ball) as made:
        write_scenario(made, made_up_scenario(), ball_head())
        (made / "preview.png").write_bytes(png())
    return tmp_path / "library"


@pytest.fixture
def make(library):
    """Makes loaders, and ends them."""
    loaders = []

    def make_one(loop, may_be_anywhere):
        loaders.append(ScenarioLoader(loop, simulation_of, may_be_anywhere, library))
        return loaders[-1]

    yield make_one
    for loader in loaders:
        loader.close()


def test_scenarios_are_listed_with_their_pictures_and_problems(make, library):
    loader = make(Loop(), may_be_anywhere=False)
    assert loader.pictures.get("ball") is None
    listed = {entry.name: entry for entry in loader.listed().result(60)}
    assert set(listed) == {"ball", "broken", "colin27"}
    assert "scenario.json" in listed["broken"].problem
    assert loader.pictures.get("ball") == library / "ball" / "preview.png"
    assert loader.pictures.get("colin27") == asset_path("scenarios", "colin27", "preview.png")
    assert loader.pictures.get("broken") is loader.pictures.get("../ball") is None


@pytest.mark.parametrize("folder", ["/etc", "../colin27"])
def test_client_on_another_computer_can_load_no_other_folder(make, folder):
    loop = Loop()
    answer = make(loop, may_be_anywhere=False).load(folder).result(60)
    assert not answer.ok
    assert "The scenarios here are ball, colin27;" in answer.message
    assert loop.simulations == []


def test_no_second_scenario_is_loaded_while_one_is_being_loaded(make):
    loop = Loop()
    handover = Future()
    loop.replace_simulation = lambda _simulation: handover
    loader = make(loop, may_be_anywhere=True)
    first = loader.load("colin27")
    others = (loader.load("colin27"), loader.reload(), loader.load("ball"))
    assert [other.result(0) for other in others] == [Answer(0, False, BEING_SET_UP)] * 3
    assert loop.is_being_replaced
    handover.set_result(loop.answer)
    assert first.result(60).ok
    assert loader.load("colin27").result(60).ok


def test_no_scenario_is_read_during_a_trial(make):
    loop = Loop()
    loop.is_trial_open = True
    loader = make(loop, may_be_anywhere=True)
    # `nowhere` would have another reason: the loader did not search it.
    assert loader.load("nowhere").result(60) == Answer(0, False, TRIAL_IS_OPEN)
    assert loader.reload().result(60) == Answer(0, False, TRIAL_IS_OPEN)
    loop.is_trial_open = False
    assert loader.load("colin27").result(60).ok


@pytest.mark.parametrize("error", [InputError("It is empty."), MemoryError()], ids=repr)
def test_trials_may_start_again_after_any_failure_and_the_answer_reports_it(
    make, monkeypatch, error
):
    loop = Loop()
    loader = make(loop, may_be_anywhere=True)

    def fail(_folder):
        assert loop.is_being_replaced
        raise error

    monkeypatch.setattr(loader, "_make_simulation", fail)
    assert loader.load("colin27").result(60) == Answer(0, False, str(error) or FAILED)
    assert not loop.is_being_replaced
    monkeypatch.undo()
    assert loader.load("colin27").result(60).ok


def test_a_scenario_with_an_infeasible_procedure_is_refused(make, monkeypatch):
    def refuse(_setup):
        raise InputError("Left has its target outside of the head.")

    monkeypatch.setattr(procedure_plan, "require_usable_procedures", refuse)
    loop = Loop()
    loader = make(loop, may_be_anywhere=True)
    scenario = SimpleNamespace(name="ball", title="Ball", procedures=("biopsy",))
    loader._make_simulation = lambda _folder: SimpleNamespace(
        setup=SimpleNamespace(scenario=scenario)
    )
    assert "outside of the head" in loader.load("ball").result(60).message
    assert loop.simulations == []
