"""A drill of decisions played by what a page draws or says, with any device."""

from __future__ import annotations

import re
from dataclasses import dataclass

from rastrainer.decision.drill_record import CASES, CONFIDENCES, FAULTS, Decision
from rastrainer_simulator.flow.session.chosen_trial import FIRST_ID
from Testing.web.trainees_on_page import AtPage

FAR_MM = 3.0
"""A checked place farther off than this stops the operation."""
MM = r"\W*([\d.]+)\smm"


@dataclass(frozen=True)
class PlayedCase:
    """The shown and chosen values of a case."""

    residual_mm: float
    true_error_mm: float
    place: str
    decision: Decision
    confidence: int
    suspected: str | None


def begin_drill(trainee: AtPage) -> None:
    trainee.choose("decide")
    if trainee.value("trainee") in ("", FIRST_ID):
        trainee.type_id()
    trainee.choose("begin")
    trainee.choose("begin")


def play_drill(trainee: AtPage) -> list[PlayedCase]:
    """Play a drill to its result, with a check in each fifth case: the arm takes ten seconds."""
    begin_drill(trainee)
    played = [play_case(trainee, 1)]
    for number in range(2, CASES + 1):
        trainee.choose("next")
        played.append(play_case(trainee, number, checks=number % 5 == 1))
    trainee.until(lambda: trainee.menu.items[0].is_enabled, "the record")
    trainee.choose("result")
    trainee.read("passed")
    trainee.choose("back")
    assert trainee.menu_name == "start"
    return played


def check_place(trainee: AtPage, number: int) -> tuple[str, float]:
    """Check one of the places; return its name, and by how much the tip is off, mm."""
    trainee.choose("check")
    places = [item.name for item in trainee.menu.items if item.name.startswith("point ")]
    place = places[5 * number % len(places)]
    trainee.choose(place)
    found = trainee.read(r"By the registration, th[^\n]*")[0]
    trainee.press("menu", lambda: trainee.menu is not None, "the case")
    off = max(map(float, re.findall(r"(\d+)\smm", found)), default=0.0)
    return place.removeprefix("point "), off


def play_case(trainee: AtPage, number: int, checks: bool = True) -> PlayedCase:
    """Check a place or none, read the images, decide, and read the truth."""
    trainee.read(rf"Case {number} of {CASES}")
    residual = float(trainee.read(rf"Residual, root mean square{MM}")[1])
    expected = float(trainee.read(rf"Expected error at the target \(95\s%\){MM}")[1])
    place, off = check_place(trainee, number) if checks else ("", 0.0)
    trainee.choose("images")
    trainee.read("sagittal slice through: Target")
    trainee.choose("back")
    decision = Decision.PROCEED if residual < expected else Decision.REGISTER_AGAIN
    if off > FAR_MM:
        decision = Decision.STOP
    confidence = CONFIDENCES[number % len(CONFIDENCES)]
    suspected = None
    trainee.choose("decide")
    trainee.choose(decision.value)
    if decision is Decision.PROCEED:
        trainee.read("The next press is final")
        trainee.choose(f"{confidence}")
    else:
        trainee.choose(f"{confidence}")
        trainee.read("The next press is final")
        suspected = FAULTS[number % len(FAULTS)].value
        trainee.choose(suspected)
    error = trainee.read(rf"Error at the target{MM} \(limit")
    trainee.read("(Right|Wrong): this registration was")
    return PlayedCase(residual, float(error[1]), place, decision, confidence, suspected)
