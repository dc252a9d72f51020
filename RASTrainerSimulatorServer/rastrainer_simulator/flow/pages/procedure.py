"""The pages of a scored procedure: its errors and lines."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from rastrainer.procedure.plan import MAX_TRAJECTORIES
from rastrainer.trial.procedure_outcome import (
    ANGLE_LIMIT_DEG,
    ENTRY_LIMIT_MM,
    PLUNGE_LIMIT_MM,
    TARGET_LIMIT_MM,
)
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.pages.trial_review import ErrorsPage
from rastrainer_simulator.flow.session.open_pages import PageContent
from rastrainer_simulator.flow.session.plan_marks import PLACED, PLANNED, SHOWN, drawn, placed_line
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.flow.session.trainee_history import detail_number
from rastrainer_simulator.presentation.screen import ErrorArrow, Fact, Screen, Tone
from rastrainer_simulator.state import TrialResult
from rastrainer_simulator.trial_state import PlannedLine

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


class ProcedureErrorsPage(SessionPage):
    """The errors of one trajectory after the other, each split into registration and hand."""

    name = "procedure-errors"
    _number = 0

    def content(self) -> PageContent:
        each = _trajectories_of(procedure_details(self.session.training.result))
        details = each[self._number] if each else {}
        name = _text(details.get("name"))

        def step(direction: int) -> None:
            self._number = (self._number + direction) % len(each)

        choice = (self.choice("trajectory", name, step),) if len(each) > 1 else ()
        lines = self.button("lines", self.open_page(ProcedureLinesPage))
        by_robot = details.get("selfAligned") is True
        text = self.say("procedure-errors.robot text" if by_robot else "procedure-errors.text")
        title = self.say("procedure-errors.title", name=name)
        rows = (*choice, lines, self.button("back"))
        return PageContent(title, (text,), self._facts(details), rows)

    def _facts(self, details: Mapping[str, Any]) -> list[Fact]:
        facts = []
        for name, whole, registration, hand, limit in _SPLIT:
            numbers = [detail_number(details, member) for member in (whole, registration, hand)]
            if None in numbers:
                continue
            values = dict(zip(("error", "registration", "hand"), numbers, strict=True))
            unit = "deg" if name == "angle" else "mm"
            text = self.say(f"procedure-errors.split {unit}", **values)
            facts.append(Fact(self.say(f"procedure-errors.{name}"), text, _tone(numbers[0], limit)))
        plunge, kept = detail_number(details, "plungeMm"), detail_number(details, "keptMm")
        label = self.say("procedure-errors.plunge")
        if plunge is None:
            missed = self.say("procedure-errors.no inner table")
            facts.append(Fact(label, missed, Tone.WARNING))
        else:
            text = self.say("result.mm", error=plunge)
            facts.append(Fact(label, text, _tone(plunge, PLUNGE_LIMIT_MM)))
        if kept is not None:
            key = "procedure-errors.hit" if kept <= 0.0 else "procedure-errors.kept"
            tone = Tone.ERROR if kept <= 0.0 else Tone.PLAIN
            nearest = _text(details.get("nearest"))
            facts.append(Fact(nearest, self.say(key, distance=kept), tone))
        return facts


class ProcedureLinesPage(ErrorsPage):
    """Shows the planned, the registered and the placed lines in the head, without a menu."""

    name = "procedure-lines"

    def screen(self) -> Screen:
        """Return the lines at the true pose of the head, which the score has revealed."""
        is_scored = self.session.training.result is not None
        lines = tuple(_lines(self.session)) if is_scored else ()
        return replace(super().screen(), errors=lines, is_head_clear=True)

    def title(self) -> str:
        return self.say("procedure-lines.title")


def _lines(session: TrainingSession) -> Iterator[ErrorArrow]:
    procedure = session.training.procedure
    assert procedure is not None, "the page is opened for a procedure"
    planned = session.scenario.procedure(procedure.name).trajectories
    for plan, trajectory in zip(planned, procedure.trajectories, strict=True):
        entry, target = map(session.truly_in_world, (plan.entry_ras, plan.target_ras))
        yield drawn(PlannedLine(plan.name, entry, target), PLANNED)
        yield drawn(trajectory.line, SHOWN)
        placed = placed_line(trajectory)
        if placed is not None:
            yield drawn(placed, PLACED)


def _tone(error: float | None, limit: float) -> Tone:
    if error is None or math.isinf(limit):
        return Tone.PLAIN
    return Tone.WARNING if abs(error) > limit else Tone.GOOD


def _text(value: object) -> str:
    return value[:LONGEST_NAME] if isinstance(value, str) and value.isprintable() else ""
