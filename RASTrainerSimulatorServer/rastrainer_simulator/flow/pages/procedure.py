"""The errors of a scored procedure."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any

from rastrainer.procedure.plan import MAX_TRAJECTORIES
from rastrainer.trial.procedure_outcome import (
    ANGLE_LIMIT_DEG,
    ENTRY_LIMIT_MM,
    PLUNGE_LIMIT_MM,
    TARGET_LIMIT_MM,
)
from rastrainer_simulator.flow.pages.session_page import SessionPage, ShownPage, page_kind
from rastrainer_simulator.flow.pages.trial_review import ErrorsPage
from rastrainer_simulator.flow.session.open_pages import PageContent
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.flow.session.trainee_history import detail_number
from rastrainer_simulator.presentation.screen import Fact, Tone
from rastrainer_simulator.state import TrialResult

LONGEST_NAME = 60
_SPLIT = (
    ("target", "targetMm", "byRegistrationMm", "byHandMm", TARGET_LIMIT_MM),
    ("entry", "entryMm", "entryByRegistrationMm", "entryByHandMm", ENTRY_LIMIT_MM),
    ("radial", "radialMm", "radialByRegistrationMm", "radialByHandMm", math.inf),
    ("depth", "depthMm", "depthByRegistrationMm", "depthByHandMm", math.inf),
    ("angle", "angleDeg", "angleByRegistrationDeg", "angleByHandDeg", ANGLE_LIMIT_DEG),
)
"""An error, its members in the details of a trajectory, and the limit of the score."""


def procedure_details(result: TrialResult | None) -> Mapping[str, Any]:
    details = None if result is None else result.details.get("procedure")
    return details if isinstance(details, dict) else {}


def procedure_facts(session: TrainingSession, result: TrialResult) -> list[Fact]:
    """Return the procedure's score and its errors in short; [] in a trial of touches alone."""
    details, say = procedure_details(result), session.texts.say
    score = detail_number(details, "score")
    if score is None:
        return []
    is_good = details.get("acceptable") is True
    key = "result.of 100" if is_good else "result.unacceptable score"
    tone = Tone.GOOD if is_good else Tone.WARNING
    facts = [Fact(say("procedure-errors.score"), say(key, score=score), tone)]
    parts = ("targetRmsMm", "targetByRegistrationRmsMm", "targetByHandRmsMm")
    numbers = [detail_number(details, name) for name in parts]
    if None not in numbers:
        values = dict(zip(("error", "registration", "hand"), numbers, strict=True))
        facts.append(Fact(say("procedure-errors.rms"), say("procedure-errors.split mm", **values)))
    each = _trajectories_of(details)
    aligned = sum(one.get("selfAligned") is True for one in each)
    if aligned:
        text = say("procedure-errors.robot lines", count=aligned, lines=len(each))
        facts.append(Fact(say("procedure-errors.robot"), text))
    return facts


def _trajectories_of(details: Mapping[str, Any]) -> Sequence[Mapping[str, Any]]:
    found = details.get("trajectories")
    listed = found[:MAX_TRAJECTORIES] if isinstance(found, list) else []
    return [each for each in listed if isinstance(each, dict)]


@page_kind("procedure-errors")
def procedure_errors_page(page: ShownPage, number: int = 0) -> PageContent:
    each = _trajectories_of(procedure_details(page.session.training.result))
    details = each[number] if each else {}
    name, say = _text(details.get("name")), page.say
    choose = partial(page.set_value, "number")
    choice = page.choice("trajectory", range(len(each)), number, choose, name)
    lines = page.button("lines", page.open_page(ErrorsPage, True))
    by_robot = details.get("selfAligned") is True
    text = say("procedure-errors.robot text" if by_robot else "procedure-errors.text")
    rows = (*((choice,) if len(each) > 1 else ()), lines, page.button("back"))
    title = say("procedure-errors.title", name=name)
    return PageContent((text,), tuple(_facts(page, details)), rows, title=title)


def _facts(page: SessionPage, details: Mapping[str, Any]) -> Iterator[Fact]:
    say = page.say
    for name, whole, registration, hand, limit in _SPLIT:
        numbers = [detail_number(details, member) for member in (whole, registration, hand)]
        if None not in numbers:
            values = dict(zip(("error", "registration", "hand"), numbers, strict=True))
            unit = "deg" if name == "angle" else "mm"
            text = say(f"procedure-errors.split {unit}", **values)
            yield Fact(say(f"procedure-errors.{name}"), text, _tone(numbers[0], limit))
    plunge, kept = detail_number(details, "plungeMm"), detail_number(details, "keptMm")
    missed, tone = say("procedure-errors.no inner table"), Tone.WARNING
    if plunge is not None:
        missed, tone = say("result.mm", error=plunge), _tone(plunge, PLUNGE_LIMIT_MM)
    yield Fact(say("procedure-errors.plunge"), missed, tone)
    if kept is not None:
        key = "procedure-errors.hit" if kept <= 0.0 else "procedure-errors.kept"
        tone = Tone.ERROR if kept <= 0.0 else Tone.PLAIN
        yield Fact(_text(details.get("nearest")), say(key, distance=kept), tone)


def _tone(error: float | None, limit: float) -> Tone:
    if error is None or math.isinf(limit):
        return Tone.PLAIN
    return Tone.WARNING if abs(error) > limit else Tone.GOOD


def _text(value: object) -> str:
    return value[:LONGEST_NAME] if isinstance(value, str) and value.isprintable() else ""
