"""The presenter and the pages for a rater who watches replays and marks them, a domain a page."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from concurrent.futures import Future
from functools import partial

from rastrainer.errors import InputError
from rastrainer.study.ratings import HIGHEST, LOWEST, MARKS, RatingDomain, RatingForm
from rastrainer_simulator.flow.session.open_pages import (
    OpenPages,
    Page,
    PageContent,
    PageRow,
    page_kind,
)
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.input.inputs import ControlContext, InputDevice, button_in_menu
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent
from rastrainer_simulator.presentation.screen import Fact, Hint, Screen, ScreenMessage, Tone
from rastrainer_simulator.rating.rating_work import RatingWork
from rastrainer_simulator.replay.playback import Playback, PlaybackSwitch
from rastrainer_simulator.replay.replay_presenter import RATE, ReplayPresenter
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
        self.pages = OpenPages(self.happened)
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
        self.pages.show(loading_page(self, self._loading))
        self._refresh()

    def rate(self) -> None:
        self._playback.pause(True)
        open_ = self.work.open_domain
        self.pages.show(rated_page(self) if open_ is None else domain_page(self, *open_))
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
        if self.pages.top is None:
            if not is_again or code in _REPEATED:
                super().on_key(view, code, is_down, text)
        elif is_down and not is_again:
            self._press(InputDevice.KEYBOARD, code)

    def on_press(self, view: int, control: str) -> None:
        """Process a button of an XR controller, or of a touch screen."""
        if self.pages.top is None:
            super().on_press(view, control)
        elif (name := button_in_menu(control)) is not None:
            self._try(partial(self.pages.pressed, name))

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

    def _press(self, device: InputDevice, name: str) -> None:
        if self.pages.top is None:
            super()._press(device, name)
        else:
            self._try(lambda: self._press_on_page(device, name))

    def _press_on_page(self, device: InputDevice, name: str) -> None:
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
            self.happened(FeedbackEvent.ERROR)
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


_KEYS = {f"{key}{mark}": mark for key in ("Digit", "Numpad") for mark in MARKS}
_SENTENCES = {LOWEST: "low", (LOWEST + HIGHEST) // 2: "middle", HIGHEST: "high"}
"""Marks that a sentence describes."""


RatingPage = Page[RatingPresenter]
"""A page that a rater reads."""


def _rows(page: RatingPage, *names: str) -> tuple[PageRow, ...]:
    desk = page.session
    acts = {
        "undo": desk.undo,
        "next": lambda: desk.load(desk.work.go_to_next),
        "previous": lambda: desk.load(desk.work.go_back),
        "leave": desk.leave,
    }
    return tuple(page.button(name, acts.get(name), page.say(f"rating.{name}")) for name in names)


def _watch(page: RatingPage, *_arguments: object) -> None:
    page.session.watch()


def _give(page: RatingPage, mark: int) -> None:
    page.session.work.give(mark)
    page.session.rate()


def _type_mark(page: RatingPage, device: InputDevice, name: str, *_domain: object) -> bool:
    is_mark = device is InputDevice.KEYBOARD and name in _KEYS
    if is_mark:
        _give(page, _KEYS[name])
    return is_mark


@page_kind("rating", back=_watch, input_pressed=_type_mark)
def domain_page(page: RatingPage, form: RatingForm, domain: RatingDomain) -> PageContent:
    """Accept one mark, three of them with their meaning, and lead to the next domain."""

    def label(mark: int) -> str:
        if mark not in _SENTENCES:
            return str(mark)
        sentence = page.say(f"rate.{domain.name}.{_SENTENCES[mark]}")
        return page.say("rating.mark", mark=mark, sentence=sentence)

    marks = (page.button(f"mark {each}", partial(_give, page, each), label(each)) for each in MARKS)
    others = _rows(page, *(["undo"] if page.session.work.marks else []), "watch", "leave")
    title = page.say("rating.title", form=form.title, domain=page.say(f"rate.{domain.name}"))
    # The focus is not on a mark, which would then be given more often than others.
    said = (page.say("rating.text"),)
    return PageContent(said, rows=(*marks, *others), title=title, first="watch")


@page_kind("rated", back=_watch)
def rated_page(page: RatingPage) -> PageContent:
    """Show the marks of a replay, and lead to the next one."""
    work = page.session.work
    facts = [
        Fact(page.say(f"rate.{domain.name}"), str(work.marks[domain.name]))
        for form in work.forms
        for domain in form.domains
        if domain.name in work.marks
    ]
    is_last = work.rated == len(work.trial_ids)
    title = page.say("rated.all" if is_last else "rated.title")
    text = page.say("rated.all text" if is_last else "rated.text", rated=work.rated)
    following = [] if is_last else ["next"]
    previous = ["previous"] if work.place else []
    rows = _rows(page, *following, "undo", "watch", *previous, "leave")
    return PageContent((text,), facts, rows, title=title, first="next")


# There is nothing to go back to yet.
@page_kind("rating-loading", back=lambda _page, _loading: None)
def loading_page(page: RatingPage, loading: Future[Playback]) -> PageContent:
    """Wait for a replay; say why where it cannot be shown."""
    error = loading.exception() if loading.done() else None
    problem = str(error) if isinstance(error, InputError) else ""
    rows = _rows(page, *(["previous"] if page.session.work.place else []), "leave")
    return PageContent((problem or page.say("rating-loading.text"),), rows=rows)
