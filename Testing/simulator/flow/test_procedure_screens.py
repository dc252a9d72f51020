"""A procedure by the keyboard alone: its texts, pictures, sounds and menus, phase by phase."""

from __future__ import annotations

import json
import math
import re

import numpy as np
import pytest
from PIL import Image

from rastrainer import transforms
from rastrainer.head.mesh import read_head_mesh
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.number_text import clock
from rastrainer.protocol import Phase
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.procedure_outcome import procedure_outcome
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.net.igtl.publisher import sim_state
from rastrainer_simulator.net.views.boards import seat_text
from rastrainer_simulator.net.views.outgoing import _procedure, state_news
from rastrainer_simulator.presentation.messages import CoveringBodies, Seat
from rastrainer_simulator.presentation.screen import Tone
from rastrainer_simulator.rendering.procedure_picture import (
    PLACED,
    PLANNED,
    SHOWN,
    draw_procedure,
    procedure_lines,
)
from rastrainer_simulator.trial_state import Tool
from Testing.simulator.flow.conftest import Outside
from Testing.simulator.flow.trainee import RATE_HZ, Keys, Trainee
from Testing.simulator.planned_procedures import ENTRIES, TARGETS, procedure_setup
from Testing.without_tutorial import WITHOUT_TUTORIAL

OFF_MM = (2.0, -1.0, 1.5)
"""Offset of the registration, as biased touches cause it."""
DRILLED_M, MICROMETER = 0.052, 1e-6


class Operation:
    """The keyboard's trainee, and the screen after each step."""

    def __init__(self, trainee: Trainee, outside: Outside):
        self.trainee, self.outside = trainee, outside
        self.seen: dict = {}

    def keep(self, name: str) -> None:
        """Record the screen, and the other messages to views."""
        trainee = self.trainee
        trainee.step(15)
        shown = trainee.presenter.shown.latest
        pictures = trainee.presenter.pictures(shown)
        procedure = _procedure(shown, pictures)
        message = None if procedure is None else record_to_json(procedure)
        self.seen[name] = trainee.presenter.screen, message, shown

    def next_step(self, item: str, tool: Tool) -> None:
        """Choose what leads to the next phase, which brings another tool."""
        trainee = self.trainee
        trainee.tap_until("touch", "procedure")
        self.seen[f"menu {item}"] = trainee.menu
        trainee.choose(item)
        self.until_tool(tool)

    def until_tool(self, tool: Tool) -> None:
        """Wait until the robot holds another tool, and its screen is shown."""
        trainee = self.trainee
        trainee.until(lambda: trainee.state.tool is tool, tool.value)
        trainee.step(3)

    def feed(self, to_m: float) -> None:
        """Hold the key that feeds until the tip is at a depth."""
        trainee = self.trainee
        trainee.presenter.on_key(1, "KeyF", True, "")
        trainee.until(lambda: trainee.state.feed >= to_m, f"a depth of {to_m} m")
        trainee.presenter.on_key(1, "KeyF", False, "")
        trainee.step(3)


@pytest.fixture(scope="module")
def operation(tmp_path_factory):
    folder = tmp_path_factory.mktemp("procedure")
    outside = Outside(folder)
    outside.has_slicer = True
    simulation = Simulation(procedure_setup(folder / "scenario"), 3)
    with ControlLoop(simulation, folder / "records", rate_hz=RATE_HZ, speed=None) as loop:
        presenter = outside.presenter(loop, **{**WITHOUT_TUTORIAL, "order": "any"})
        trainee = Trainee(loop, presenter, Keys)
        try:
            operation = Operation(trainee, outside)
            perform(operation)
            yield operation
        finally:
            trainee.close()
            presenter.close()


def perform(operation: Operation) -> None:
    trainee = operation.trainee
    begin(operation)
    trainee.tap("touch")
    trainee.until(lambda: trainee.state.training.procedure.checkpoints, "a touched checkpoint")
    operation.keep("verifying")
    # The menu of a phase also opens by a click on its hint.
    assert "press undo" in {hint.item for hint in trainee.presenter.screen.hints}
    trainee.presenter.on_item(1, "press undo")
    trainee.until_menu("procedure")
    trainee.choose("accept")
    operation.until_tool(Tool.GUIDE)
    operation.keep("aligning")
    for number in range(2):
        trainee.tap_until("undo", "procedure")
        trainee.choose("align")
        trainee.until(is_aligned(trainee), "the guide on the line")
        operation.keep(f"aligned {number}")
        operation.next_step("lock", Tool.DRILL)
        if number == 0:
            retract(operation)
        operation.feed(DRILLED_M)
        operation.keep(f"drilled {number}")
        operation.next_step("insert", Tool.ELECTRODE)
        target_m = trainee.presenter.screen.ruler.target_mm / MM_PER_M
        operation.feed(target_m - 0.001)
        operation.keep(f"inserted {number}")
        if number == 1:
            operation.feed(target_m + 0.0012)
            operation.keep("past the target")
        operation.next_step("release", (Tool.GUIDE, Tool.POINTER)[number])
    score(operation)


def begin(operation: Operation) -> None:
    """Choose a procedure and a task, touch all points wherever the tip is, and register them."""
    trainee = operation.trainee
    trainee.go_to_experiment("P07")
    trainee.focus("procedure")
    trainee.tap("right")
    trainee.choose("task-1", None)
    trainee.touch_anywhere()
    trainee.tap_until("touch", "complete")
    trainee.choose("register")
    trainee.until(lambda: trainee.state.training.phase is Phase.VERIFYING, "the verification")
    operation.keep("waiting for a registration")
    trainee.tap_until("undo", "procedure")
    operation.seen["menu without a registration"] = trainee.menu
    trainee.choose("work")
    off = np.eye(4)
    off[:3, 3] = OFF_MM
    matrix = off @ transforms.inverse(trainee.loop.simulation.truth.head_to_world)
    operation.registration = {
        "trialId": trainee.state.training.trial_id,
        "matrix": matrix.ravel().tolist(),
        "freMm": 0.9,
        "expectedTreMm": 1.2,
    }
    assert trainee.submit("UseRegistration", **operation.registration).ok


def is_aligned(trainee: Trainee):
    def is_aligned() -> bool:
        alignment = trainee.state.alignment
        return alignment.is_exact and abs(alignment.stand_off - 0.03) < MICROMETER

    return is_aligned


def retract(operation: Operation) -> None:
    """Remove the drill before it has cut anything, and lock the guide again."""
    trainee = operation.trainee
    trainee.tap_until("undo", "procedure")
    trainee.choose("retract")
    operation.until_tool(Tool.GUIDE)
    operation.next_step("lock", Tool.DRILL)


def score(operation: Operation) -> None:
    """Score it as Slicer does, and view all pages of the result."""
    trainee = operation.trainee
    trainee.until_menu("waiting")
    data = trainee.submit("GetTrial", trialId=operation.registration["trialId"]).data
    record = record_from_json(TrialRecord, data["record"])
    truth = trainee.submit("SubmitRegistration", **operation.registration).data
    head_to_world = np.reshape(truth["headToWorld"], (4, 4))
    scenario = trainee.loop.setup.scenario
    operation.outcome = procedure_outcome(record, scenario, head_to_world)
    operation.record, operation.head_to_world = record.procedure, head_to_world
    details = {"procedure": operation.outcome.summary()}
    scored = trainee.submit("TrialScored", trialId=record.trial_id, score=70.0, details=details)
    assert scored.ok, scored.message
    trainee.until_menu("result")
    operation.seen["result"] = trainee.menu
    trainee.choose("procedure", "procedure-errors")
    operation.seen["errors"] = [trainee.menu]
    trainee.focus("trajectory")
    trainee.tap("right")
    operation.seen["errors"].append(trainee.menu)
    trainee.choose("lines", None)
    operation.keep("lines")
    trainee.tap_until("back", "procedure-errors")


def screen_of(operation: Operation, name: str):
    return operation.seen[name][0]


def told_of(operation: Operation, name: str):
    return operation.seen[name][1]


def shown_in_world(operation: Operation, point_ras) -> np.ndarray:
    """Return where the registration shows a point of the plan, (3,) m."""
    matrix = np.reshape(operation.registration["matrix"], (4, 4))
    return transforms.apply(transforms.inverse(matrix), np.array(point_ras)) / MM_PER_M


def test_the_trials_clock_stops_at_the_last_touch_and_the_procedures_runs_apart(operation):
    screen, _message, state = operation.seen["inserted 1"]
    completed, procedure = state.training.touches[-1].elapsed, state.procedure_time
    assert state.completion_time == completed < state.elapsed - procedure
    assert f"Procedure: {clock(procedure)}" in screen.status
    told = record_to_json(
        state_news(state, 0, operation.trainee.presenter.pictures(state), CoveringBodies())
    )
    assert told["elapsedS"] == pytest.approx(completed, abs=1e-5)
    sent = json.loads(sim_state({}, state, 1).content.text)
    assert sent["elapsedS"] == pytest.approx(completed, abs=1e-3)
    assert json.loads(seat_text(state, Seat()))["elapsedS"] == int(completed)
    facts = {fact.label: fact.value for fact in operation.seen["result"].facts}
    ended = operation.trainee.state
    assert facts["Time"] == clock(completed)
    assert facts["Time of the procedure"] == clock(ended.procedure_time)


def test_the_menu_offers_what_is_possible_now(operation):
    menu = operation.seen["menu without a registration"]
    items = {item.name: item.is_enabled for item in menu.items}
    assert items == {"accept": False, "again": True, "work": True}
    for item, names in (
        ("lock", ["lock", "align", "work"]),
        ("insert", ["insert", "retract", "work"]),
    ):
        assert [each.name for each in operation.seen[f"menu {item}"].items] == names


def test_the_error_at_a_checkpoint_follows_from_the_registration(operation):
    screen, _message, state = operation.seen["verifying"]
    (checked,) = state.training.procedure.checkpoints
    error_mm = MM_PER_M * checked.error
    assert f"{checked.name}: {error_mm:.1f} mm off" in screen.status
    assert [arrow.tone for arrow in screen.errors].count(Tone.GOOD) == 1
    assert len({arrow.name for arrow in screen.errors} - {""}) == len(screen.errors) == 3
    assert checked.name in {arrow.name for arrow in screen.errors if arrow.tone is Tone.GOOD}
    assert not screen.is_head_clear
    actions = {hint.item: hint.action for hint in screen.hints}
    assert actions["press undo"] == "Accept, repeat …"


@pytest.mark.parametrize(("name", "number"), [("aligning", 0), ("aligned 1", 1)])
def test_the_current_line_is_drawn_where_the_registration_places_it(operation, name, number):
    screen = screen_of(operation, name)
    assert screen.is_head_clear
    (line,) = [
        arrow for arrow in screen.errors if arrow.tone is Tone.GOOD and arrow.begin != arrow.end
    ]
    target, entry = (shown_in_world(operation, each[number]) for each in (TARGETS, ENTRIES))
    assert line.end == pytest.approx(target, abs=MICROMETER)
    toward = (target - entry) / np.linalg.norm(target - entry)
    assert line.begin == pytest.approx(entry - 0.05 * toward, abs=MICROMETER)
    tables = [arrow.begin for arrow in screen.errors if arrow.tone is Tone.WARNING]
    assert len(tables) == 2
    for table in tables:
        beside = np.cross(np.array(table) - entry, toward)
        assert np.linalg.norm(beside) < MICROMETER


def test_the_bulls_eye_agrees_with_the_numbers_until_the_guide_is_on_the_line(operation):
    aim, state = told_of(operation, "aligning")["aim"], operation.seen["aligning"][2]
    assert math.hypot(*aim["entryMm"]) == pytest.approx(aim["entryDistanceMm"], abs=0.02)
    assert aim["angleDeg"] == pytest.approx(math.degrees(state.alignment.angle), abs=0.01)
    apart = np.subtract(aim["targetMm"], aim["entryMm"])
    length = MM_PER_M * math.dist(*(shown_in_world(operation, e[0]) for e in (ENTRIES, TARGETS)))
    assert np.linalg.norm(apart) == pytest.approx(
        length * math.sin(state.alignment.angle), abs=0.02
    )
    for number in range(2):
        aim = told_of(operation, f"aligned {number}")["aim"]
        assert max(map(abs, (*aim["entryMm"], *aim["targetMm"], aim["angleDeg"]))) <= 0.05


def test_the_ruler_measures_from_the_guides_tip_according_to_the_plan(operation):
    for number in range(2):
        screen, message, _state = operation.seen[f"drilled {number}"]
        assert message["tool"] == "drill"
        assert message["aim"] is None
        ruler = screen.ruler
        length_mm = math.dist(ENTRIES[number], TARGETS[number])
        assert ruler.entry_mm == pytest.approx(30.0, abs=0.1)
        assert ruler.target_mm == pytest.approx(30.0 + length_mm, abs=0.1)
        assert ruler.inner_mm - ruler.outer_mm == pytest.approx(6.0, abs=1.5)
        inserted = told_of(operation, f"inserted {number}")
        assert inserted["tool"] == "electrode"
        assert inserted["feedMm"] == pytest.approx(ruler.target_mm - 1.0, abs=0.5)


def test_what_the_drill_meets_is_shown_and_heard(operation):
    kinds = operation.trainee.watcher.kinds
    assert "checkpoint" in kinds
    assert kinds.count("bone") == kinds.count("through") == 2

    def warned(name):
        return [message.text for message in screen_of(operation, name).warnings]

    assert warned("drilled 0") == ["The drill is through the bone: stop."]
    assert warned("inserted 0") == warned("inserted 1") == []
    (past,) = warned("past the target")
    assert re.fullmatch(r"1\.[1-9] mm past the target: draw back\.", past)


def test_the_result_splits_the_errors_into_registration_and_hand(operation):
    each = operation.outcome.analysis.trajectories
    for menu, errors in zip(operation.seen["errors"], each, strict=True):
        facts = {fact.label: fact.value for fact in menu.facts}
        target = errors.target_point_error
        assert facts["Target point error"] == (
            f"{target.mm:.2f} mm ({target.by_registration_mm:.2f} / {target.by_hand_mm:.2f})"
        )
        assert target.by_registration_mm == pytest.approx(float(np.linalg.norm(OFF_MM)), abs=0.01)
        assert facts["Plunge depth"] == f"{errors.plunge_mm:.2f} mm"
        assert {"Entry point error", "Radial error", "Angular deviation"} <= set(facts)
    result = operation.seen["result"]
    score = operation.outcome.score
    assert result.facts[0].label == "Score of the procedure"
    assert f"{score.score:.0f} / 100" in result.facts[0].value


def test_the_lines_on_the_head_show_plan_registration_and_instrument(operation, tmp_path):
    screen = screen_of(operation, "lines")
    assert screen.is_head_clear
    truth, scenario = operation.trainee.loop.simulation.truth, operation.trainee.loop.setup.scenario
    tones = [arrow.tone for arrow in screen.errors]
    assert tones == [Tone.GOOD, Tone.WARNING, Tone.PLAIN] * 2
    for number, errors in enumerate(operation.outcome.analysis.trajectories):
        planned, shown, placed = screen.errors[3 * number : 3 * number + 3]
        true_target = truth.in_world(np.array(TARGETS[number])) / MM_PER_M
        assert planned.end == pytest.approx(true_target, abs=MICROMETER)
        assert shown.end == pytest.approx(shown_in_world(operation, TARGETS[number]), abs=1e-6)
        tip = truth.in_world(np.array(errors.tip_ras)) / MM_PER_M
        assert placed.end == pytest.approx(tip, abs=MICROMETER)
    procedure, path = scenario.procedure("dbs"), tmp_path / "procedure.png"
    lines = procedure_lines(operation.record, procedure, operation.head_to_world)
    drawn = [truth.in_world(np.array(line[1])) / MM_PER_M for three in lines for line in three]
    np.testing.assert_allclose(drawn, [arrow.end for arrow in screen.errors], atol=MICROMETER)
    draw_procedure(path, read_head_mesh(scenario.head), procedure, lines)
    pixels = np.asarray(Image.open(path).convert("RGB")).reshape(-1, 3)
    for color in (PLANNED, SHOWN, PLACED):
        is_that = np.abs(pixels - 255.0 * np.array(color.color)).max(axis=1) < 40.0
        assert is_that.sum() > 100, color.name
