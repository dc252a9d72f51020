"""The menu in which a trainee chooses a head, with its pictures."""

from pathlib import Path

import pytest

from rastrainer.scenario.library import ListedScenario
from rastrainer_simulator.server.scenario_loader import FAILED
from rastrainer_simulator.state import Answer
from rastrainer_simulator.texts.texts import ENGLISH, LANGUAGES

LOADING = ENGLISH["being set up"]


@pytest.fixture
def heads(outside):
    folder = Path("nowhere")
    outside.scenarios = [
        ListedScenario("colin27", "Colin27 head", folder, folder / "preview.png", ""),
        ListedScenario("mine", "My head", folder, None, ""),
        ListedScenario("broken", "broken", folder, None, "scenario.json is empty."),
    ]
    return outside


@pytest.fixture
def at_heads(heads, trainee):  # noqa: ARG001
    trainee.open_experiment()
    trainee.presenter.on_text(1, "trainee", "P07")
    trainee.step()
    assert trainee.item("scenario").value == "Colin27 head"
    trainee.choose("scenario", "scenario")
    return trainee


def test_heads_are_listed_with_pictures_and_unusable_ones_say_why(at_heads):
    items = {item.name: item for item in at_heads.menu.items}
    assert list(items) == ["head colin27", "head mine", "head broken", "back"]
    assert at_heads.menu.focus == "head colin27"
    assert items["head colin27"].picture == "/scenarios/colin27.png"
    assert items["head colin27"].value == "in use"
    assert items["head mine"].picture == ""
    assert not items["head broken"].is_enabled
    assert items["head broken"].help == "scenario.json is empty."
    at_heads.tap_until("back", "experiment")


def test_a_chosen_head_is_loaded_and_no_task_begins_until_then(at_heads, heads):
    at_heads.choose("head mine")
    at_heads.until(lambda: at_heads.item("head mine").value == "is being loaded", "the loading")
    assert [name for name, _ in heads.loads] == ["mine"]
    assert not at_heads.item("head colin27").is_enabled
    at_heads.tap_until("back", "experiment")
    assert not at_heads.item("trial-run").is_enabled
    heads.loads[0][1].set_result(Answer(0, True))
    at_heads.until(lambda: at_heads.item("trial-run").is_enabled, "the task may begin")


def test_a_refused_head_changes_nothing_and_the_reason_is_said_in_the_trainees_language(
    at_heads, heads
):
    at_heads.presenter._session.prefer(language="de")
    at_heads.choose("head mine")
    at_heads.step()
    heads.loads[0][1].set_result(Answer(0, False, FAILED))
    at_heads.until(lambda: at_heads.presenter.screen.warnings, "the reason")
    (warning,) = at_heads.presenter.screen.warnings
    assert warning.text == LANGUAGES["de"]["scenario failed"]
    assert at_heads.menu.name == "scenario"
    at_heads.choose("head colin27")
    at_heads.step()
    heads.loads[1][1].set_result(Answer(0, True))
    at_heads.until_menu("experiment")


def test_nothing_begins_in_the_menus_while_a_client_loads_a_head(at_heads):
    session = at_heads.presenter._session
    session.prefer(tutorial="required")
    at_heads.tap_until("back", "experiment")
    begun = at_heads.loop.begin_replacement()
    at_heads.until(begun.done)
    at_heads.until(lambda: at_heads.item("tutorial").help == LOADING, "the reason")
    assert not at_heads.item("trial-run").is_enabled
    assert at_heads.presenter.start_tutorial("P08", "desktop") == Answer(0, False, LOADING)
    assert session.trainee == "P07"
    session.begin_tutorial()
    assert session.tutorial is None
    assert [warning.text for warning in at_heads.presenter._flow.screen().warnings] == [LOADING]
    at_heads.loop.end_replacement()
    at_heads.until(lambda: at_heads.item("tutorial").is_enabled, "the tutorial may begin")
