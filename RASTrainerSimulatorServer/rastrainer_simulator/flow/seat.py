"""The seat as a teacher's board shows it, and what a teacher orders there."""

from __future__ import annotations

from rastrainer.protocol import OPEN_PHASES
from rastrainer_simulator.flow.flow import Flow
from rastrainer_simulator.flow.pages.result import ResultPage
from rastrainer_simulator.flow.pages.trial_review import ReplayPage
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.presentation.messages import InstructorOrder, Seat
from rastrainer_simulator.presentation.screen import Screen, Tone

_WRONG = (Tone.WARNING, Tone.ERROR)
SENTENCE_S = 20.0
"""How long the trainee sees a teacher's message: longer than a notice, as it is unexpected."""


def seat_of(session: TrainingSession, screen: Screen, holder: str, count: int) -> Seat:
    """Return what a board shows of a seat; `count` is how many points its trial has."""
    training, curriculum = session.training, session.curriculum
    is_open = training.phase in OPEN_PHASES
    trainee = training.trainee if is_open else session.trainee_id
    scores = [trial.score for trial in session.history.of(trainee) if not trial.is_aborted]
    return Seat(
        trainee=trainee,
        task=session.task_title(training.task) if is_open else "",
        count=count if is_open else 0,
        screen="" if screen.menu is None else screen.menu.title,
        instruction=screen.instruction.text,
        warnings=tuple(each.text for each in screen.warnings if each.tone in _WRONG),
        score=scores[-1] if scores else None,
        holder=holder,
        slicer=session.services.is_slicer_connected(),
        language=screen.language,
        assignments="" if curriculum is None else session.assignment_texts.in_brief(curriculum),
    )


def instruct(session: TrainingSession, flow: Flow, order: InstructorOrder, text: str) -> str:
    """Carry out a teacher's order; return why it is impossible, or ""."""
    if order is InstructorOrder.SAY:
        said = session.texts.say("instructor.says", text=text)
        session.notices.add(said, seconds=SENTENCE_S)
        return ""
    if order is InstructorOrder.PAUSE:
        is_shown = flow.playback is not None
        is_running = session.training.is_running
        if not is_shown and not (is_running or session.tutorial is not None):
            return session.texts.say("instructor.nothing runs")
        flow.pause("unseen.instructor")
        return ""
    page = session.pages.top
    if isinstance(page, ReplayPage):
        return ""
    if not isinstance(page, ResultPage):
        return session.texts.say("instructor.no result")
    page.show_again()
    return ""
