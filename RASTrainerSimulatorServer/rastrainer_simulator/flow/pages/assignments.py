"""The assignments of a trainee's curriculum: where they stand, and what to practice next."""

from __future__ import annotations

from rastrainer.scenario.scenario import method_of
from rastrainer.study.curriculum.curriculum_message import AssignmentMessage
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.session.chosen_trial import start_task
from rastrainer_simulator.flow.session.obstacles import assignment_obstacle
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.net.views.screen import Menu, MenuItem

_PREFIX = "assignment "
"""No assignment's name has a space: none is taken for the way back."""


class AssignmentsPage(SessionPage):
    """Lists the assignments, the one to practice next in focus; each begins its trial."""

    name = "assignments"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        told = session.curriculum
        self.first = "" if told is None else _PREFIX + told.next

    def menu(self) -> Menu:
        """Return the list as Slicer told it last."""
        told = self.session.curriculum
        back = self.button("back")
        if told is None:
            return Menu(self.name, self.say("assignments.title"), items=(back,))
        said = (told.title, self.session.assignment_words.advice(told))
        items = tuple(self._item(each) for each in told.assignments)
        return Menu(self.name, self.say("assignments.title"), said, items=(*items, back))

    def accept(self, item: str) -> None:
        """Begin a trial of an assignment, or go back."""
        session, told = self.session, self.session.curriculum
        each = None if told is None else told.find(item.removeprefix(_PREFIX))
        if item == "back" or each is None:
            self.back()
            return
        session.mode = each.mode or session.mode
        session.method, session.procedure = method_of(each.method), each.procedure
        start_task(session, each.task)

    def advance(self, dt: float) -> None:  # noqa: ARG002
        """Close where the trainee has no curriculum any more."""
        if self.session.curriculum is None:
            self.back()

    def _item(self, each: AssignmentMessage) -> MenuItem:
        words = self.session.assignment_words
        reason = assignment_obstacle(self.session, each)
        return MenuItem(
            _PREFIX + each.name,
            words.label(each),
            value=words.progress(each),
            is_enabled=not reason,
            help=reason or f"{words.title(each)}. {words.goal(each)}",
        )
