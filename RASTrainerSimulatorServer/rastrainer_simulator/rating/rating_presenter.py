"""The presenter and the pages for a rater who watches replays and marks them, a domain a page."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from concurrent.futures import Future
from functools import partial

from rastrainer.errors import InputError
from rastrainer.study.ratings import HIGHEST, LOWEST, MARKS, RatingDomain, RatingForm
from rastrainer_simulator.flow.session.open_pages import OpenPages, Page, PageContent, PageRow
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.input.inputs import ControlContext, ControlName, InputDevice
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent, feedback_of
from rastrainer_simulator.presentation.screen import Fact, Hint, Screen, ScreenMessage, Tone
from rastrainer_simulator.rating.rating_work import RatingWork
from rastrainer_simulator.replay.playback import Playback, PlaybackSwitch
from rastrainer_simulator.replay.replay_presenter import IN_MENUS, RATE, ReplayPresenter
from rastrainer_simulator.state import StepResult
from rastrainer_simulator.texts.texts import LANGUAGES, Texts, input_label, pair_label

_REPEATED = ("ArrowLeft", "ArrowRight")


class RatingPresenter(ReplayPresenter):
    """The presenter for one rater: replays under numbers, and the pages of the forms over them."""

    def __init__(
        self,
        work: RatingWork,
        first: Playback,
        load: Callable[[str], Future[Playback]],
        language: str,
        end: Callable[[], None],
    ) -> None:
        """Begin with a replay; `load` begins to load another, by its trial's UUID."""
        self.work = work
        self.pages = OpenPages(self._happened)
        self.shown = PlaybackSwitch(first)
        self.shown.show(first)
        self.leave = end
        self._load = load
        self._loading: Future[Playback] | None = None
        self._keys: dict[int, set[str]] = {}
        self._problem = ""
        blinded = Texts(LANGUAGES[language]).say("rating.replay", **work.numbers)
        super().__init__(first, language, self.rate, blinded)
        if work.open_domain is None:
            self.rate()

    def say(self, key: str, **values: object) -> str:
        """Return a sentence in the chosen language, with the replay's number among all."""
        return self._texts.say(key, **self.work.numbers, **values)

    def advance(self, dt: float) -> None:
        self.pages.advance(dt)
        loading = self._loading
        if loading is None or not loading.done():
            return
        self._loading = None
        if loading.exception() is None:
            self._watch(loading.result())
        else:
            # The page says why.
            self._refresh()

    def watch(self) -> None:
        """Show the present replay again, from where it was left or, at its end, the beginning."""
        self.pages.show(None)
        self._playback.pause(False)
        self._refresh()

    def load(self, go: Callable[[], object]) -> None:
        go()
        self._loading = self._load(self.work.trial_id)
        self.pages.show(LoadingPage(self, self._loading))
        self._refresh()

    def rate(self) -> None:
        self._playback.pause(True)
        open_ = self.work.open_domain
        self.pages.show(RatedPage(self) if open_ is None else DomainPage(self, *open_))
        self._refresh()

    def undo(self) -> None:
        self.work.undo()
        self.rate()

    def view_left(self, view: int) -> None:
        super().view_left(view)
        self._keys.pop(view, None)

    def on_key(self, view: int, code: str, is_down: bool, text: str) -> None:
        """Process a key: for the open page, else for the replay.

        One that is held is taken once, or it would mark one domain after the other; only the
        arrows go on through the replay.
        """
        keys = self._keys.setdefault(view, set())
        is_again = is_down and code in keys
        (keys.add if is_down else keys.discard)(code)
        if not is_again or (self.pages.top is None and code in _REPEATED):
            super().on_key(view, code, is_down, text)

    def input_pressed(self, device: InputDevice, name: str) -> None:
        """Process an input that is newly pressed: for the open page, else for the replay."""
        if self.pages.top is None:
            super().input_pressed(device, name)
        else:
            self._try(lambda: self._page_pressed(device, name))

    def on_press(self, view: int, control: str) -> None:
        """Process a button of an XR controller, or of a touch screen."""
        if self.pages.top is None:
            super().on_press(view, control)
        elif control in ControlName._value2member_map_:
            name = ControlName(control)
            self._try(lambda: self.pages.pressed(IN_MENUS.get(name, name)))

    def on_item(self, view: int, name: str) -> None:  # noqa: ARG002
        """Process a click on an item of the page, or on the hint that leads to the form."""
        if self.pages.top is None and name == RATE:
            self._try(self.rate)
        else:
            self._try(lambda: self.pages.choose(name))

    def _watch(self, playback: Playback) -> None:
        self.shown.show(playback)
        self.pages.show(None)
        self._play(playback, self.say("rating.replay"))

    def _page_pressed(self, device: InputDevice, name: str) -> None:
        page = self.pages.top
        if page is None or page.input_pressed(device, name):
            return
        control = DEFAULT_BINDINGS.control(device, name, ControlContext.MENU)
        if control is not None:
            self.pages.pressed(control)

    def _try(self, act: Callable[[], None]) -> None:
        self._problem = ""
        try:
            act()
        except InputError as error:
            self._problem = str(error)
            self._happened(FeedbackEvent.ERROR)
        self._refresh()

    def _follow(self, result: StepResult) -> None:
        if self.pages.top is None:
            super()._follow(result)

    def _make_screen(self) -> Screen:
        menu, say = self.pages.menu(), self._texts.say
        screen = super()._make_screen()
        if menu is not None:
            up, down, enter, escape = (
                input_label(self._texts, InputDevice.KEYBOARD.value, code)
                for code in ("ArrowUp", "ArrowDown", "Enter", "Escape")
            )
            choose = Hint(pair_label(up, down), say("hint.choose"))
            hints = (choose, Hint(enter, say("hint.accept")), Hint(escape, say("hint.back")))
            screen = Screen(menu=menu, hints=hints, language=self._language)
        problem = (ScreenMessage(self._problem, Tone.ERROR),) if self._problem else ()
        return dataclasses.replace(screen, warnings=(*screen.warnings, *problem))

    def _happened(self, what: FeedbackEvent) -> None:
        self._count += 1
        self.updates.publish(feedback_of(what, self._count))


_KEYS = {f"{key}{mark}": mark for key in ("Digit", "Numpad") for mark in MARKS}
_SENTENCES = {LOWEST: "low", (LOWEST + HIGHEST) // 2: "middle", HIGHEST: "high"}
"""Marks that a sentence describes."""


class RatingPage(Page):
    """A page that a rater reads."""

    def __init__(self, actions: RatingPresenter) -> None:
        self.actions = actions

    def say(self, key: str, **values: object) -> str:
        """Return a sentence with the replay's number."""
        return self.actions.say(key, **values)

    def rows(self, *names: str) -> tuple[PageRow, ...]:
        actions = self.actions
        acts = {
            "undo": actions.undo,
            "next": lambda: actions.load(actions.work.go_to_next),
            "previous": lambda: actions.load(actions.work.go_back),
            "leave": actions.leave,
        }
        return tuple(
            self.button(name, acts.get(name), self.say(f"rating.{name}")) for name in names
        )

    def back(self) -> None:
        self.actions.watch()


class DomainPage(RatingPage):
    """Accepts one mark, and leads to the next domain."""

    name = "rating"

    def __init__(self, actions: RatingPresenter, form: RatingForm, domain: RatingDomain) -> None:
        super().__init__(actions)
        self._form, self._domain = form, domain

    def content(self) -> PageContent:
        """Return the marks, three of them with their meaning."""
        marks = (
            self.button(f"mark {mark}", partial(self._give, mark), self._label(mark))
            for mark in MARKS
        )
        others = self.rows(*(["undo"] if self.actions.work.marks else []), "watch", "leave")
        domain = self.say(f"rate.{self._domain.name}")
        title = self.say("rating.title", form=self._form.title, domain=domain)
        # The focus is not on a mark, which would then be given more often than others.
        said = (self.say("rating.text"),)
        return PageContent(said, rows=(*marks, *others), title=title, first="watch")

    def input_pressed(self, device: InputDevice, name: str) -> bool:
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
        following = [] if is_last else ["next"]
        previous = ["previous"] if work.place else []
        rows = self.rows(*following, "undo", "watch", *previous, "leave")
        return PageContent((text,), facts, rows, title=title, first="next")


class LoadingPage(RatingPage):
    """Waits for a replay; says why where it cannot be shown."""

    name = "rating-loading"

    def __init__(self, actions: RatingPresenter, loading: Future[Playback]) -> None:
        super().__init__(actions)
        self._loading = loading

    def content(self) -> PageContent:
        problem = ""
        if self._loading.done():
            error = self._loading.exception()
            problem = str(error) if isinstance(error, InputError) else ""
        text = problem or self.say("rating-loading.text")
        rows = self.rows(*(["previous"] if self.actions.work.place else []), "leave")
        return PageContent((text,), rows=rows)

    def back(self) -> None:
        """There is nothing to go back to yet."""
