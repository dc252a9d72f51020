"""The drill of decisions at the screens: its cases, checks, decisions and result."""

from __future__ import annotations

import itertools
from unittest import mock

import numpy as np
import pytest

from rastrainer.decision.drill_record import Decision, Fault
from rastrainer.study_messages import StudyStep
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.decision import drill, forms
from rastrainer_simulator.decision.cases import CaseMaker, DecisionCase
from rastrainer_simulator.presentation.screen import SliceMark, Tone


@pytest.fixture(scope="module")
def cases(setup):
    """A short form: a case that must be registered again, and a sound one."""
    maker = CaseMaker(setup.scenario)

    def first(fault: Fault, is_sound: bool) -> DecisionCase:
        made = (maker.case(seed, fault) for seed in itertools.count())
        fits = (each for each in made if each.is_sound == is_sound and not len(each.trace_mm))
        return next(fits)

    return first(Fault.MOVED_HEAD, False), first(Fault.BAD_FIDUCIAL, True)


@pytest.fixture(autouse=True)
def _short_drills(cases):
    with (
        mock.patch.object(drill, "CASES", len(cases)),
        mock.patch.object(forms, "draw_form", return_value=cases),
    ):
        yield


def until_case(trainee, number: int) -> None:
    """Wait until a case is prepared and shown."""
    trainee.until_menu("case")
    title = f"Case {number} of 2"
    trainee.until(lambda: trainee.menu.facts and trainee.menu.title == title, title)


def begin(trainee) -> None:
    """Go from the start menu to the first case of a new drill of the usual trainee."""
    trainee.choose("decide", "decide")
    trainee.choose("begin", "decide-introduction")
    trainee.choose("begin")
    until_case(trainee, 1)


def check(trainee, place: str) -> None:
    trainee.choose("check", "case-places")
    trainee.choose(f"point {place}", None)
    trainee.until(lambda: trainee.presenter.screen.instruction.text.startswith("By the"), place)


def decide(trainee, *pressed: str) -> None:
    """Press an item in each menu of the decision."""
    menus = ("case-confidence", "case-suspect")[: len(pressed) - 1]
    for press, menu in zip(pressed, (*menus, "case-truth"), strict=True):
        trainee.choose(press, menu)


def test_a_drill_is_played_by_gamepad(pilot, loop, cases):
    """It is played whole, with a check and the images of the first case."""
    begin(pilot)
    check(pilot, "Nasion")
    pilot.tap_until("menu", "case")
    pilot.choose("images", "case-images")
    pilot.choose("back", "case")
    pilot.choose("decide", "case-decision")
    decide(pilot, "register again", "90", "moved head")
    harmful, sound = (case.is_sound for case in cases)
    assert (harmful, sound) == (False, True)
    assert pilot.menu.title == "Right: this registration was off"
    pilot.choose("next")
    until_case(pilot, 2)
    pilot.choose("decide", "case-decision")
    decide(pilot, "proceed", "80")
    pilot.until(lambda: pilot.item("result").is_enabled, "the record")
    pilot.choose("result", "drill-result")
    assert pilot.menu.title.startswith("Passed")
    pilot.until(lambda: loop.archive.unacknowledged(), "the delivery")
    (record,) = loop.archive.unacknowledged()
    first, second = record.cases
    assert (first.checks, first.has_read_images) == (("Nasion",), True)
    assert first.suspected is Fault.MOVED_HEAD
    assert (second.decision, second.confidence) == (Decision.PROCEED, 80)


def test_the_robot_goes_to_one_checked_place_after_the_other(trainee, cases):
    begin(trainee)
    for number, place in enumerate(("Vertex", "Nasion"), start=1):
        check(trainee, place)
        goal = cases[0].tip_for(cases[0].places[place])
        away = np.linalg.norm(MM_PER_M * np.array(trainee.state.tip) - goal)
        said = trainee.presenter.screen.instruction
        assert f"{away:.0f} mm" in said.text if said.tone is Tone.WARNING else away < 1.0
        assert not trainee.presenter.screen.warnings
        clock = trainee.presenter.screen.status[1]
        assert clock <= ("01:50", "01:40")[number - 1], "a check takes ten seconds"
        trainee.tap_until("menu", "case")
        assert trainee.item("check").value == f"{number}"
    trainee.choose("check", "case-places")
    assert trainee.item("point Vertex").value == "checked"


def test_who_listens_hears_how_far_a_checked_place_is(trainee, cases):
    trainee.presenter._session.prefer(speech=True)
    begin(trainee)
    check(trainee, "Nasion")
    off = np.subtract(
        cases[0].truly(cases[0].places["Nasion"]), MM_PER_M * np.array(trainee.state.tip)
    )
    step = 5 if np.linalg.norm(off) >= 20 else 1
    said = f"nasion: {step * round(np.linalg.norm(off) / step):.0f} mm"
    trainee.until(lambda: said in trainee.presenter.screen.instruction.text, said)


def test_fiducials_are_drawn_where_they_are_and_the_tip_where_the_registration_puts_it(
    trainee, cases
):
    begin(trainee)
    trainee.choose("look", None)
    marks = {each.name: each.end for each in trainee.presenter.screen.errors}
    assert set(marks) == set(cases[0].labels)
    for label, place in zip(cases[0].labels, cases[0].fixed_mm, strict=True):
        assert marks[label] == pytest.approx(cases[0].truly(place) / MM_PER_M, abs=1e-4)
    trainee.tap_until("touch", "case-images")
    slices = trainee.menu.slices
    tip = cases[0].in_images(MM_PER_M * np.array(trainee.state.tip))
    offset = tip - cases[0].target_mm
    axial = next(each for each in slices.slices if each.name == "Axial")
    assert axial.letters == ("R", "L", "P", "A"), "as radiologists see it"
    marks = {line.mark: np.array(line.points[0]) for line in axial.lines}
    drawn = marks[SliceMark.TIP] - marks[SliceMark.TARGET]
    assert drawn == pytest.approx([-offset[0], offset[1]], abs=0.2)


def test_the_truth_shows_where_the_robot_really_gets_and_nothing_can_be_taken_back(trainee, cases):
    begin(trainee)
    trainee.choose("decide", "case-decision")
    trainee.choose("proceed", "case-confidence")
    trainee.tap_until("back", "case-decision")
    decide(trainee, "proceed", "100")
    title = trainee.menu.title
    assert title == "Wrong: this registration was off"
    off = np.zeros(3)
    rows = {"Axial": (0, 1), "Coronal": (0, 2), "Sagittal": (1, 2)}
    for each in trainee.menu.slices.slices:
        marks = {line.mark: np.array(line.points[0]) for line in each.lines}
        off[list(rows[each.name])] = marks[SliceMark.REACHED] - marks[SliceMark.TARGET]
    assert np.linalg.norm(off) == pytest.approx(cases[0].true_error_mm, abs=0.3)
    trainee.tap_until("back", "case-leave")
    trainee.choose("stay", "case-truth")
    trainee.choose("leave", "case-leave")
    trainee.choose("leave", "start")
    trainee.choose("decide", "decide")
    trainee.choose("continue", "case-truth")
    trainee.until(lambda: trainee.menu.title == title, "the truth")
    trainee.choose("next")
    until_case(trainee, 2)


def test_the_decision_opens_when_the_time_is_over(trainee):
    begin(trainee)
    trainee.step_s = 1.0
    trainee.until(lambda: trainee.menu.clock.tone is Tone.WARNING, "the last seconds")
    assert trainee.menu.clock.text == "00:20"
    trainee.until_menu("case-decision")
    assert (trainee.menu.clock.text, trainee.menu.clock.tone) == ("00:00", Tone.ERROR)
    trainee.choose("back", "case")
    for name in ("look", "check", "images"):
        assert not trainee.item(name).is_enabled
        assert trainee.item(name).help == "The time is over: decide."
    trainee.step(5)
    assert trainee.menu.name == "case", "the page that the trainee has left stays closed"
    trainee.choose("decide", "case-decision")
    decide(trainee, "stop", "50", "bent tool")


def test_a_drill_that_was_left_goes_on_at_its_clock(trainee):
    begin(trainee)
    check(trainee, "Nasion")
    trainee.tap_until("menu", "case")
    trainee.choose("leave", "case-leave")
    trainee.choose("leave", "start")
    trainee.step_s = 1.0
    trainee.step(30)
    trainee.step_s = 0.016
    trainee.choose("decide", "decide")
    trainee.choose("continue")
    until_case(trainee, 1)
    assert trainee.menu.clock.text > "01:30"
    assert trainee.item("check").value == "1"


def test_slicer_opens_a_drill(trainee, presenter):
    assert presenter.start_drill("P9", "desktop").data == {}
    trainee.until_menu("decide-introduction")
    trainee.choose("begin")
    until_case(trainee, 1)
    answer = presenter.start_drill("P9", "desktop")
    assert answer.data["trialId"] == presenter._session.drill.trial_id
    assert "P9" in presenter.start_drill("P8", "desktop").message
    assert not presenter.start_tutorial("P9", "desktop").ok
    trainee.start("task-1")
    assert presenter.start_drill("P9", "desktop").message.startswith("P07 is still doing")


def test_a_study_decides_when_a_drill_comes(trainee, outside):
    steps = outside.services.assigned
    steps.take_step(StudyStep("7", "decide", 2, 3, task="decide", mode="desktop"))
    trainee.go_to_experiment("7")
    assert not trainee.item("task-1").is_enabled
    trainee.choose("decide", "decide")
    assert trainee.item("begin").is_enabled
    steps.take_step(StudyStep("7", "trial", 2, 3, task="task-1", mode="desktop"))
    trainee.step(20)
    assert not trainee.item("begin").is_enabled
