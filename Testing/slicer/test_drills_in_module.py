"""A drill of decisions in the module: started, stored once when it is delivered, and shown."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rastrainer.decision.drill_score import drill_score
from rastrainer.json_records import record_to_json
from rastrainer.number_text import fixed
from rastrainer.study.database.study import Study
from Testing.drawn_drills import draw_drill
from Testing.slicer.simulator_double import connect_module, run_until_received

SHIPPED = Path(__file__).parents[2] / "assets" / "studies" / "published-protocol.json"


def drill(seed=1, **changes):
    return replace(draw_drill(np.random.default_rng(seed), "T001"), **changes)


def delivered(record, **changes):
    return {"task": "decide", **record_to_json(record), **changes}


@pytest.fixture
def module(fresh_module, simulator):
    """The module with the chosen trainee T001, connected to a simulator double."""
    fresh_module.press("createTraineeButton")
    connect_module(fresh_module, simulator)
    return fresh_module


def received(simulator, name):
    """The arguments of the commands of a name that have arrived."""
    return [arguments for sent, arguments in simulator.commands if sent == name]


def commands(host, simulator, name):
    """The same, with the commands that were in transit."""
    run_until_received(host.widget.logic.session.link)
    return received(simulator, name)


def stored(host):
    with Study.open(host.find("studyPathLineEdit").currentPath) as study:
        return [each for one in study.trainees() for each in study.drills(one.pseudonym)]


def test_a_delivered_drill_is_stored_once_acknowledged_and_shown_without_any_length(
    module, simulator
):
    record = drill()
    for _ in range(2):
        simulator.send_command("TrialCompleted", delivered(record))
    module.wait_until(lambda: module.find("historyTable").rowCount == 1, "it is in the history")
    module.wait_until(lambda: received(simulator, "AcknowledgeTrial"), "the drill is acknowledged")
    assert stored(module) == [record]
    score = drill_score(record.cases)
    ((number, _start, task, _time, error, shown),) = module.cells("historyTable")
    assert (number, error, shown) == ("", "–", fixed(score.score, 1))
    sensitivity = fixed(score.sensitivity.value, 1)
    assert task == f"Decide: d′ {sensitivity}\nharmful {score.harmful}, vain {score.vain}"
    opened = lambda: not module.find("scoreCollapsibleButton").collapsed  # noqa: E731
    module.wait_until(opened, "the score is shown")
    assert module.text("scoreMessageText") == "T001, Decide, Desktop"
    rows = {title: (value, note) for title, value, note in module.cells("scoreTable")}
    assert rows["Score"][0] == f"{fixed(score.score, 2)} / 100"
    assert rows["Harmful decisions"] == (str(score.harmful), "proceeded, of 10 beyond the limit")
    assert "mm" not in str(rows) + module.text("feedbackText")
    assert "Harmful decisions: " in module.text("feedbackText")
    with pytest.raises(AssertionError, match="Choose a trial first"):
        module.press("replayButton")
    module.press("showTablesButton")
    assert module.text("scoreMessageText") == "The score is now a table in the scene."
    assert commands(module, simulator, "SubmitRegistration") == []


def test_a_bad_drill_is_refused_with_a_sentence_and_stored_once_it_is_right(module, simulator):
    record = drill()
    worse = delivered(record)
    worse["cases"] = [*worse["cases"][:-1], {**worse["cases"][-1], "confidence": 200}]
    for bad, words in (
        (worse, "cases[19].confidence must be"),
        (delivered(record, trainee="T\u202e001"), "trainee must be"),
    ):
        simulator.send_command("TrialCompleted", bad)
        shown = lambda words=words: words in module.text("trainingMessageText")  # noqa: E731
        module.wait_until(shown, f"it is refused: {words}")
    assert commands(module, simulator, "AcknowledgeTrial") == []
    assert stored(module) == []
    simulator.send_command("TrialCompleted", delivered(record))
    module.wait_until(lambda: stored(module) == [record], "the drill is stored")
    # A trainee who was deleted does not come back with an old offer, which then ends.
    module.answer("Delete", "Yes")
    module.press("deleteTraineeButton")
    before = len(commands(module, simulator, "AcknowledgeTrial"))
    simulator.send_command("TrialCompleted", delivered(record))
    acknowledged = lambda: len(received(simulator, "AcknowledgeTrial")) > before  # noqa: E731
    module.wait_until(acknowledged, "the offer is acknowledged")
    assert stored(module) == []


def test_a_drill_is_chosen_as_a_task_and_started_in_the_mode_of_the_section_or_the_study(
    module, simulator, tmp_path
):
    module.press("loadScenarioButton")
    module.wait_until(lambda: " now uses " in module.text("scenarioText"), "it is loaded")
    module.choose("taskComboBox", "Decide")
    assert "proceed, register again or stop" in module.text("scenarioText")
    module.press("showScenarioButton")
    module.press("startTaskButton")
    assert module.text("startTaskButton") == "Start Decide"
    started = {"trainee": "T001", "mode": "desktop"}
    assert commands(module, simulator, "StartDrill") == [started]
    simulator.responder = lambda name, _arguments: "A drill is open." if "Drill" in name else {}
    module.press("startTaskButton")
    refused = lambda: module.text("trainingMessageText") == "A drill is open."  # noqa: E731
    module.wait_until(refused, "the refusal is shown")
    protocol = {**json.loads(SHIPPED.read_text()), "drills": ["before-all"], "questionnaires": []}
    (tmp_path / "protocol.json").write_text(json.dumps(protocol))
    module.type("protocolPathLineEdit", str(tmp_path / "protocol.json"))
    module.answer("Begin the study", "Yes")
    module.press("beginStudyButton")
    module.press("enrollButton")
    assert module.text("stepText").endswith("Do the drill of decisions with the headset.")
    module.press("startTaskButton")
    assert "the study asks for something else first" in module.messages[-1].text
    simulator.responder = lambda _name, _arguments: {}
    # The drill that was started has not arrived yet.
    assert module.text("nextStepButton") == "Show the drill"
    module.press("nextStepButton")
    assert commands(module, simulator, "StartDrill")[2:] == [{"trainee": "T001", "mode": "hmd"}]
    steps = commands(module, simulator, "StudyStep")
    assert [steps[-1][key] for key in ("kind", "task", "mode")] == ["decide", "decide", "hmd"]
    # The simulator took its step for done.
    simulator.send_command("TrialCompleted", delivered(drill(3, mode="hmd")))
    asked = lambda: received(simulator, "StudyStep")[len(steps) :]  # noqa: E731
    module.wait_until(asked, "a drill that does not count is asked for again")
    assert asked()[-1] == steps[-1]
    utc = {"started_utc": "2999-01-01T10:00:00Z", "completed_utc": "2999-01-01T10:30:00Z"}
    simulator.send_command("TrialCompleted", delivered(drill(2, mode="hmd", **utc)))
    done = lambda: received(simulator, "StudyStep")[-1]["kind"] == "trial-run"  # noqa: E731
    module.wait_until(done, "the step is done, and the next one is sent")
    assert module.text("nextStepButton") == "Start the step"
