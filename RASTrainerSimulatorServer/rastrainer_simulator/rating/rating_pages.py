"""A rater's work and pages: replay by replay, one domain a page."""

from __future__ import annotations

import uuid
from collections.abc import Sequence
from concurrent.futures import Future
from functools import partial
from typing import Protocol

from rastrainer.errors import InputError
from rastrainer.study.ratings import HIGHEST, LOWEST, MARKS, RatingDomain, RatingForm, RatingStore
from rastrainer_simulator.flow.session.open_pages import OpenPages, Page, PageContent, PageRow
from rastrainer_simulator.input.inputs import InputDevice
from rastrainer_simulator.presentation.screen import Fact
from rastrainer_simulator.replay.playback import Playback
from rastrainer_simulator.texts.texts import Texts


class RatingWork:
    """The replays of one rater, and the marks on the forms that are filled in for each.

    Every mark is stored when it is given, so that a rater can stop and resume at any time.

    Attributes:
        trial_ids: In the rater's order; their places are all that the rater learns about them.
        place: Of the present replay, from 0.
    """

    def __init__(
        self, store: RatingStore, rater: str, trial_ids: Sequence[str], forms: Sequence[RatingForm]
    ) -> None:
        """Resume at the first replay that is not rated."""
        self.trial_ids = tuple(trial_ids)
        self.forms = tuple(forms)
        self.place = 0
        self._store = store
        self._rater = rater
        self._marks = {trial_id: store.marks(rater, trial_id) for trial_id in self.trial_ids}
        self.go_to_next()

    @property
    def trial_id(self) -> str:
        """UUID of the present replay's trial, never to be shown."""
        return self.trial_ids[self.place]

    @property
    def marks(self) -> dict[str, int]:
        """The marks of the present replay, by domain, in the order in which they were given."""
        return self._marks[self.trial_id]

    @property
    def open_domain(self) -> tuple[RatingForm, RatingDomain] | None:
        """The first domain of the present replay without a mark; None where all have one."""
        return self._open_of(self.marks)

    @property
    def rated(self) -> int:
        """How many replays are rated."""
        return sum(self._open_of(marks) is None for marks in self._marks.values())

    def give(self, mark: int) -> None:
        if self.open_domain is not None:
            form, domain = self.open_domain
            self._store_mark(form, domain.name, mark)

    def undo(self) -> bool:
        """Withdraw the last mark of this replay; return whether there was one."""
        names = {domain.name: form for form in self.forms for domain in form.domains}
        given = [domain for domain in self.marks if domain in names]
        if given:
            self._store_mark(names[given[-1]], given[-1], None)
        return bool(given)

    def go_to_next(self) -> bool:
        """Go to the next replay that is not rated, around the end; return whether there is one."""
        count = len(self.trial_ids)
        for step in range(count):
            place = (self.place + step) % count
            if self._open_of(self._marks[self.trial_ids[place]]) is not None:
                self.place = place
                return True
        return False

    def go_back(self) -> None:
        """Go to the previous replay, to view its marks or to correct them."""
        self.place = max(0, self.place - 1)

    def _open_of(self, marks: dict[str, int]) -> tuple[RatingForm, RatingDomain] | None:
        for form in self.forms:
            for domain in form.domains:
                if domain.name not in marks:
                    return form, domain
        return None

    def _store_mark(self, form: RatingForm, domain: str, mark: int | None) -> None:
        trial_id = self.trial_id
        self._store.give(str(uuid.uuid4()), self._rater, trial_id, form, domain, mark)
        self._marks[trial_id] = self._store.marks(self._rater, trial_id)


_KEYS = {f"{key}{mark}": mark for key in ("Digit", "Numpad") for mark in MARKS}
_SENTENCES = {LOWEST: "low", (LOWEST + HIGHEST) // 2: "middle", HIGHEST: "high"}
"""Marks that a sentence describes."""


class RatingActions(Protocol):
    """What the pages need from the program."""

    work: RatingWork
    texts: Texts
    pages: OpenPages

    def watch(self) -> None:
        """Show the present replay again."""

    def load(self) -> None:
        """Load the present replay, and show it."""

    def rate(self) -> None:
        """Open the page for marking, or the marks."""

    def leave(self) -> None:
        """End the program."""


class RatingPage(Page):
    """A page that a rater reads."""

    def __init__(self, actions: RatingActions) -> None:
        self.actions = actions

    def say(self, key: str, **values: object) -> str:
        """Return a sentence in the chosen language, with the replay's number among all."""
        work = self.actions.work
        place = {"number": work.place + 1, "count": len(work.trial_ids)}
        return self.actions.texts.say(key, **place, **values)

    def rows(self, *names: str) -> tuple[PageRow, ...]:
        """Return buttons that several pages have; "watch" goes back."""
        acts = {"undo": self._undo, "previous": self._go_back, "leave": self._leave}
        return tuple(
            self.button(name, acts.get(name), self.say(f"rating.{name}")) for name in names
        )

    def back(self) -> None:
        """Watch the replay again."""
        self.actions.watch()

    def _undo(self) -> None:
        self.actions.work.undo()
        self.actions.rate()

    def _go_back(self) -> None:
        self.actions.work.go_back()
        self.actions.load()

    def _leave(self) -> None:
        self.actions.leave()


class DomainPage(RatingPage):
    """Accepts one mark, and leads to the next domain."""

    name = "rating"

    def __init__(self, actions: RatingActions, form: RatingForm, domain: RatingDomain) -> None:
        super().__init__(actions)
        self._form, self._domain = form, domain

    def content(self) -> PageContent:
        """Return the marks, three of them with what they mean."""
        marks = (
            self.button(f"mark {mark}", partial(self._give, mark), self._label(mark))
            for mark in MARKS
        )
        others = self.rows(*(["undo"] if self.actions.work.marks else []), "watch", "leave")
        domain = self.say(f"rate.{self._domain.name}")
        title = self.say("rating.title", form=self._form.title, domain=domain)
        # The focus is not on a mark, which would then be given more often than others.
        said = (self.say("rating.text"),)
        return PageContent(title, said, rows=(*marks, *others), first="watch")

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        """Store a typed mark."""
        if device is not InputDevice.KEYBOARD or name not in _KEYS:
            return False
        self._give(_KEYS[name])
        return True

    def _give(self, mark: int) -> None:
        self.actions.work.give(mark)
        self.actions.rate()

    def _label(self, mark: int) -> str:
        if mark not in _SENTENCES:
            return str(mark)
        sentence = self.say(f"rate.{self._domain.name}.{_SENTENCES[mark]}")
        return self.say("rating.mark", mark=mark, sentence=sentence)


class RatedPage(RatingPage):
    """Shows the marks of a replay, and leads to the next one."""

    name = "rated"

    def content(self) -> PageContent:
        work = self.actions.work
        facts = [
            Fact(self.say(f"rate.{domain.name}"), str(work.marks[domain.name]))
            for form in work.forms
            for domain in form.domains
            if domain.name in work.marks
        ]
        is_last = work.rated == len(work.trial_ids)
        title = self.say("rated.all" if is_last else "rated.title")
        text = self.say("rated.all text" if is_last else "rated.text", rated=work.rated)
        following = self.button("next", self._go_on, self.say("rating.next"))
        previous = ["previous"] if work.place else []
        others = self.rows("undo", "watch", *previous, "leave")
        rows = (*(() if is_last else (following,)), *others)
        return PageContent(title, (text,), facts, rows, first="next")

    def _go_on(self) -> None:
        self.actions.work.go_to_next()
        self.actions.load()


class LoadingPage(RatingPage):
    """Waits for a replay; says why where it cannot be shown."""

    name = "rating-loading"

    def __init__(self, actions: RatingActions, loading: Future[Playback]) -> None:
        super().__init__(actions)
        self._loading = loading

    def content(self) -> PageContent:
        problem = ""
        if self._loading.done():
            error = self._loading.exception()
            problem = str(error) if isinstance(error, InputError) else ""
        text = problem or self.say("rating-loading.text")
        rows = self.rows(*(["previous"] if self.actions.work.place else []), "leave")
        return PageContent(self.say("rating-loading.title"), (text,), rows=rows)

    def back(self) -> None:
        """There is nothing to go back to yet."""
