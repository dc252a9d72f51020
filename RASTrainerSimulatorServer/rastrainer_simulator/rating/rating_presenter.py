"""What views show and accept while a rater watches replays and marks them: one domain a page."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from functools import partial

from rastrainer.errors import InputError
from rastrainer.study.ratings import HIGHEST, LOWEST, MARKS, RatingDomain, RatingForm
from rastrainer_simulator.flow.session.open_pages import OpenPages, Page, PageContent, PageRow
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.input.gamepads import w3c_gamepad_inputs
from rastrainer_simulator.input.inputs import ControlContext, ControlName, InputDevice
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent, feedback_of
from rastrainer_simulator.presentation.messages import InstructorOrder
from rastrainer_simulator.presentation.presenter import Presenter, ViewUpdate
from rastrainer_simulator.presentation.screen import Fact, Hint, Screen, ScreenMessage, Tone
from rastrainer_simulator.rating.rating_work import RatingWork
from rastrainer_simulator.replay.playback import Playback, PlaybackSwitch
from rastrainer_simulator.replay.replay_presenter import RATE, ReplayPresenter
from rastrainer_simulator.state import SimulationState
from rastrainer_simulator.texts.texts import LANGUAGES, Texts, input_label, pair_label
from rastrainer_simulator.viewpoint.view_control import Pictures

_DOWN = 0.5
_REPEATED = ("ArrowLeft", "ArrowRight")
_IN_MENUS = {ControlName.TOUCH: ControlName.ACCEPT, ControlName.UNDO: ControlName.BACK}


class RatingPresenter(Presenter):
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
        super().__init__()
        self.work = work
        self.texts = Texts(LANGUAGES[language])
        self.pages = OpenPages(self._happened)
        self.shown = PlaybackSwitch(first)
        self.leave = end
        self._language, self._load = language, load
        self._loading: Future[Playback] | None = None
        self._held: dict[int, tuple[frozenset[int], frozenset[int]]] = {}
        self._keys: dict[int, set[str]] = {}
        self._problem = ""
        self._count = 0
        self.screen = Screen()
        self._watch(first)
        if work.open_domain is None:
            self.rate()

    def advance(self, dt: float) -> None:
        """Show what is loaded."""
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
        self.playback.pause(False)
        self._refresh()

    def load(self, go: Callable[[], object]) -> None:
        """Go to another replay and load it."""
        go()
        self._loading = self._load(self.work.trial_id)
        self.pages.show(LoadingPage(self, self._loading))
        self._refresh()

    def rate(self) -> None:
        """Open the next domain that has no mark, or the marks of the replay."""
        self.playback.pause(True)
        open_ = self.work.open_domain
        self.pages.show(RatedPage(self) if open_ is None else DomainPage(self, *open_))
        self._refresh()

    def undo(self) -> None:
        self.work.undo()
        self.rate()

    def pictures(self, now: SimulationState) -> Pictures:
        return self._replay.pictures(now)

    def instruct(self, order: InstructorOrder, text: str) -> str:
        """Refuse: a recorded trial takes no orders."""
        return self._replay.instruct(order, text)

    def view_left(self, view: int) -> None:
        self._held.pop(view, None)
        self._keys.pop(view, None)
        self._replay.view_left(view)

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
                self._replay.on_key(view, code, is_down, text)
        elif is_down and not is_again:
            self._do(lambda: self._page_pressed(InputDevice.KEYBOARD, code))

    def on_layout(self, view: int, keys: Mapping[str, str]) -> None:
        """Name the replay's keys as on the latest keyboard: the pages' own are no letters."""
        self._replay.on_layout(view, keys)

    def on_pad(self, view: int, axes: Sequence[float], buttons: Sequence[float]) -> None:
        """Process a gamepad: what is newly pressed is for the open page, else for the replay."""
        now = _pressed(axes), _pressed(buttons)
        before = self._held.get(view, (frozenset(), frozenset()))
        self._held[view] = now
        moved, tapped = (
            [value * (number in new - old) for number, value in enumerate(values)]
            for values, new, old in zip((axes, buttons), now, before, strict=True)
        )
        if self.pages.top is not None:
            inputs = w3c_gamepad_inputs(moved, tapped)
            names = [name for name, value in inputs.items() if value > _DOWN]

            def press() -> None:
                for name in names:
                    self._page_pressed(InputDevice.GAMEPAD, name)

            self._do(press)
            return
        # Released at once: a button that has led from the form back here is not pressed again.
        self._replay.on_pad(view, axes, tapped)
        self._replay.on_pad(view, axes, ())

    def on_press(self, view: int, control: str) -> None:
        """Process a button of an XR controller, or of a touch screen."""
        if self.pages.top is None:
            self._replay.on_press(view, control)
        elif control in ControlName._value2member_map_:
            name = ControlName(control)
            self._do(lambda: self.pages.pressed(_IN_MENUS.get(name, name)))

    def on_orbit(self, view: int, around_deg: float, higher_deg: float, zoom: float) -> None:
        self._replay.on_orbit(view, around_deg, higher_deg, zoom)

    def on_item(self, view: int, name: str) -> None:  # noqa: ARG002
        """Process a click on an item of the page, or on the hint that leads to the form."""
        if self.pages.top is None and name == RATE:
            self._do(self.rate)
        else:
            self._do(lambda: self.pages.choose(name))

    def on_visibility(self, view: int, is_visible: bool) -> None:
        self._replay.on_visibility(view, is_visible)

    def on_silence(self, view: int) -> None:
        self._replay.on_silence(view)

    def _watch(self, playback: Playback) -> None:
        """Show a replay from its beginning, under its number."""
        place = {"number": self.work.place + 1, "count": len(self.work.trial_ids)}
        blinded = self.texts.say("rating.replay", **place)
        self.playback = playback
        self.shown.show(playback)
        self._replay = ReplayPresenter(playback, self._language, self.rate, blinded)
        self._replay.updates.add(self._pass_on)
        self.pages.show(None)
        self._refresh()

    def _pass_on(self, update: ViewUpdate) -> None:
        """Pass on the replay's feedback, while it is watched."""
        if self.pages.top is not None:
            return
        if isinstance(update, Screen):
            self._refresh()
        else:
            self.updates.publish(update)

    def _page_pressed(self, device: InputDevice, name: str) -> None:
        page = self.pages.top
        if page is None or page.input_pressed(device, name):
            return
        control = DEFAULT_BINDINGS.control(device, name, ControlContext.MENU)
        if control is not None:
            self.pages.pressed(control)

    def _do(self, act: Callable[[], None]) -> None:
        """Carry out the request, and report failures."""
        self._problem = ""
        try:
            act()
        except InputError as error:
            self._problem = str(error)
            self._happened(FeedbackEvent.ERROR)
        self._refresh()

    def _refresh(self) -> None:
        menu, say = self.pages.menu(), self.texts.say
        problem = (ScreenMessage(self._problem, Tone.ERROR),) if self._problem else ()
        screen = self._replay.screen
        if menu is not None:
            up, down, enter, escape = (
                input_label(self.texts, InputDevice.KEYBOARD.value, code)
                for code in ("ArrowUp", "ArrowDown", "Enter", "Escape")
            )
            choose = Hint(pair_label(up, down), say("hint.choose"))
            hints = (choose, Hint(enter, say("hint.accept")), Hint(escape, say("hint.back")))
            screen = Screen(menu=menu, hints=hints, language=self._language)
        screen = dataclasses.replace(screen, warnings=(*screen.warnings, *problem))
        if screen != self.screen:
            self.screen = screen
            self.updates.publish(screen)

    def _happened(self, what: FeedbackEvent) -> None:
        self._count += 1
        self.updates.publish(feedback_of(what, self._count))


def _pressed(values: Sequence[float]) -> frozenset[int]:
    """Return which axes or buttons are away from rest."""
    return frozenset(number for number, value in enumerate(values) if abs(value) > _DOWN)


_KEYS = {f"{key}{mark}": mark for key in ("Digit", "Numpad") for mark in MARKS}
_SENTENCES = {LOWEST: "low", (LOWEST + HIGHEST) // 2: "middle", HIGHEST: "high"}
"""Marks that a sentence describes."""


class RatingPage(Page):
    """A page that a rater reads."""

    def __init__(self, actions: RatingPresenter) -> None:
        self.actions = actions

    def say(self, key: str, **values: object) -> str:
        """Return a sentence in the chosen language, with the replay's number among all."""
        work = self.actions.work
        place = {"number": work.place + 1, "count": len(work.trial_ids)}
        return self.actions.texts.say(key, **place, **values)

    def rows(self, *names: str) -> tuple[PageRow, ...]:
        """Return buttons that several pages have; "watch" goes back."""
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
        following = [] if is_last else ["next"]
        previous = ["previous"] if work.place else []
        rows = self.rows(*following, "undo", "watch", *previous, "leave")
        return PageContent(title, (text,), facts, rows, first="next")


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
        return PageContent(self.say("rating-loading.title"), (text,), rows=rows)

    def back(self) -> None:
        """There is nothing to go back to yet."""
