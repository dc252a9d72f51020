"""All joined views, and what is sent to them."""

from __future__ import annotations

import asyncio
import itertools
import logging
import time
from collections.abc import Iterable, Sequence

from rastrainer.errors import InputError
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.loop.results import StateSource
from rastrainer_simulator.loop.timing import Pacer
from rastrainer_simulator.net.limits import ViewLimits
from rastrainer_simulator.net.views import outgoing
from rastrainer_simulator.net.views.boards import Boards
from rastrainer_simulator.net.views.incoming import DESKTOP, HEADSET
from rastrainer_simulator.net.views.outgoing import Mirror, TraceUpdate
from rastrainer_simulator.net.views.view_socket import ViewSocket
from rastrainer_simulator.presentation.presenter import Control, Feedback, Presenter, ViewUpdate
from rastrainer_simulator.presentation.screen import Screen, without_secrets
from rastrainer_simulator.scene.scene_files import SceneFiles
from rastrainer_simulator.state import SimulationState
from rastrainer_simulator.viewpoint.arm_cover import ArmCover, places_to_see
from rastrainer_simulator.viewpoint.view_control import Pictures

_log = logging.getLogger(__name__)

_WATCH_PERIOD_S = 0.05
_BEFORE_BUILDING_AHEAD_S = 3.0
ENDING = "The simulator has been stopped."


class JoinedViews:
    """The joined views; `is_due` may be called in any thread, all else in the event loop's.

    Attributes:
        mirror: what spectators are shown of who wears a headset.
    """

    def __init__(
        self, source: StateSource, presenter: Presenter, scenes: SceneFiles, limits: ViewLimits
    ) -> None:
        self._source = source
        self._presenter = presenter
        self._scenes = scenes
        self._limits = limits
        self._views: dict[int, ViewSocket] = {}
        self._boards = Boards()
        self._numbers = itertools.count(1)
        self._pacer = Pacer(limits.state_hz)
        self._setup: SimulationSetup | None = None
        self._task = ""
        self._scene = ""
        self._pairing = ""
        self._trace = TraceUpdate()
        self._cover: ArmCover | None = None
        self.mirror = Mirror()
        self._loading: asyncio.Task[None] | None = None
        self._watching: asyncio.Task[None] | None = None
        self._unsubscribe = presenter.subscribe(self._send_update)

    def next_number(self) -> int:
        """Return a number that no other view has had."""
        return next(self._numbers)

    async def serve(self, view: ViewSocket) -> None:
        """Have a view take part, or a spectator or a board watch, until it leaves."""
        if view.is_board:
            await self._boards.serve(view, self._source.latest, self._presenter.seat())
            return
        self._views[view.number] = view
        try:
            if not view.is_spectator:
                self._presenter.view_joined(view.number, view.hello)
            if view.hello.kind == HEADSET:
                self.mirror.joined(view.number)
            self._send_all(view)
            self._watch()
            await view.serve()
        finally:
            view.held.release()
            del self._views[view.number]
            self.mirror.left(view.number)
            if not view.is_spectator:
                self._presenter.view_left(view.number)

    def announce_pairing(self, code: str, addresses: Sequence[str]) -> None:
        """Send the views of this computer how others are paired, now and whenever one joins."""
        self._pairing = outgoing.pairing(code, addresses)
        for view in self._views.values():
            self._put_pairing(view)

    async def close(self) -> None:
        """Send everyone away and stop."""
        self._unsubscribe()
        tasks = [task for task in (self._loading, self._watching) if task is not None]
        for task in tasks:
            task.cancel()
        closings = [view.close(ENDING) for view in self._views.values()]
        closings.append(self._boards.close(ENDING))
        await asyncio.gather(*tasks, *closings, return_exceptions=True)

    def is_due(self, _state: SimulationState) -> bool:
        return bool(self._views or self._boards) and self._pacer.is_due(time.monotonic())

    def tell(self, now: SimulationState) -> None:
        """Send what moves, and check whether it needs another scene."""
        if self._boards.is_due(time.monotonic()):
            self._boards.tell(now, self._presenter.seat())
        if not self._views:
            return
        self._look_for_scene(now)
        text = self._state_text(now)
        for view in self._views.values():
            self._put_state(view, text)
        news = self._trace.news(now, self._presenter.trace_guidance(now), time.monotonic())
        if news is not None:
            for view in self._views.values():
                view.outbox.put_event(news)

    def _send_all(self, view: ViewSocket) -> None:
        """Send a view that has just joined the present state."""
        now = self._source.latest
        self._look_for_scene(now)
        put = view.outbox.put_latest
        put(outgoing.WELCOME, outgoing.welcome(view.number))
        if self._scene:
            put(outgoing.SCENE, self._scene)
        put(outgoing.CONTROL, outgoing.control(self._presenter.control, view.number))
        self._send_screen(self._presenter.screen, (view,))
        self._put_state(view, self._state_text(now))
        trace = self._trace.everything()
        if trace is not None:
            view.outbox.put_event(trace)
        self._put_pairing(view)

    def _put_state(self, view: ViewSocket, text: str) -> None:
        if view.is_spectator:
            text = outgoing.mirrored(text, self.mirror.text)
        view.outbox.put_latest(outgoing.STATE, text)

    def _put_pairing(self, view: ViewSocket) -> None:
        # By the code a spectator could come back as one who drives.
        if view.is_local and self._pairing and not view.is_spectator:
            view.outbox.put_latest(outgoing.PAIRING, self._pairing)

    def _state_text(self, now: SimulationState) -> str:
        statistics = self._source.statistics
        delayed = statistics.late + statistics.skipped
        presenter = self._presenter
        pictures = presenter.pictures(now)
        translucent = self._translucent(now, pictures)
        return outgoing.state(now, delayed, pictures, translucent, presenter.ghost(now))

    def _translucent(self, now: SimulationState, pictures: Pictures) -> dict[str, list[str]]:
        """Return the bodies that cover tip or next point in each picture."""
        setup = self._source.setup
        if self._cover is None or self._cover.setup is not setup:
            self._cover = ArmCover(setup)
        eyes = {
            "view": pictures.main.position,
            "inset": None if pictures.inset is None else pictures.inset.position,
            "worn": self.mirror.eyes,
        }
        guided = self._presenter.trace_guidance(now).next_place
        places = places_to_see(now, setup.scenario, None if guided is None else guided.position)
        return self._cover.covering(now, eyes, places)

    def _send_update(self, update: ViewUpdate) -> None:
        views, screen = self._views.values(), self._presenter.screen
        if isinstance(update, Screen):
            self._send_screen(update, views)
        elif isinstance(update, Feedback):
            text = outgoing.event(update)
            for view in views:
                # How often the focus clicks says which item was chosen.
                if not screen.is_private or self._is_operators(view):
                    view.outbox.put_event(text)
        elif isinstance(update, Control):
            for view in views:
                view.outbox.put_latest(outgoing.CONTROL, outgoing.control(update, view.number))
            if screen.is_private:
                self._send_screen(screen, views)

    def _send_screen(self, screen: Screen, views: Iterable[ViewSocket]) -> None:
        """Send a screen; private parts only to the operator's views."""
        whole = outgoing.screen(screen)
        bare = outgoing.screen(without_secrets(screen)) if screen.is_private else whole
        for view in views:
            is_whole = not screen.is_private or self._is_operators(view)
            view.outbox.put_latest(outgoing.SCREEN, whole if is_whole else bare)

    def _is_operators(self, view: ViewSocket) -> bool:
        if view.is_spectator:
            return False
        number = self._presenter.control.view
        holding = None if number is None else self._views.get(number)
        # A gamepad at the simulator, and each of its windows, belongs to all of these windows.
        is_own = number is None or (holding is not None and holding.hello.kind == DESKTOP)
        return view is holding or (is_own and view.hello.kind == DESKTOP)

    def _look_for_scene(self, now: SimulationState) -> None:
        setup, training = self._source.setup, now.training
        # Landmarks are not marked: the trainee has to find them.
        task = training.task if training.is_marked else ""
        if setup is self._setup and task == self._task:
            return
        self._setup, self._task = setup, task
        if self._loading is not None:
            self._loading.cancel()
        self._loading = asyncio.create_task(self._load_scene(setup, task))

    async def _load_scene(self, setup: SimulationSetup, task: str) -> None:
        try:
            file = await self._scenes.scene(setup, task)
            self._scene = outgoing.scene(file.sha256, setup.scenario, task, setup.settings.axes)
            for view in self._views.values():
                view.outbox.put_latest(outgoing.SCENE, self._scene)
            # The views that have just got this scene need the processor first.
            await asyncio.sleep(_BEFORE_BUILDING_AHEAD_S)
            await self._scenes.build_all(setup)
        except InputError as error:
            _log.error("%s", error)

    def _watch(self) -> None:
        if self._watching is None:
            self._watching = asyncio.create_task(self._release_silent())

    async def _release_silent(self) -> None:
        while True:
            await asyncio.sleep(_WATCH_PERIOD_S)
            for view in tuple(self._views.values()):
                view.release_if_silent(self._limits.silent_s)
                if view.has_fallen_silent(self._limits.lost_s):
                    self._presenter.on_silence(view.number)
