"""All joined views, and the messages sent to them."""

from __future__ import annotations

import asyncio
import dataclasses
import itertools
import logging
import time
from collections.abc import Iterable, Sequence

from aiohttp import WSCloseCode, web

from rastrainer.errors import InputError
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.loop.results import StateSource
from rastrainer_simulator.loop.timing import Pacer
from rastrainer_simulator.net.limits import ViewLimits
from rastrainer_simulator.net.views.boards import seat_text
from rastrainer_simulator.net.views.outgoing import (
    BODIES,
    TraceUpdate,
    scene_news,
    screen_text,
    state_news,
)
from rastrainer_simulator.net.views.view_socket import ViewSocket
from rastrainer_simulator.presentation.messages import (
    PROTOCOL,
    ControlNews,
    CoveringBodies,
    Feedback,
    HeadsetPose,
    Hello,
    PairingNews,
    SceneNews,
    ScreenNews,
    SeatNews,
    StateNews,
    WelcomeNews,
    message_text,
)
from rastrainer_simulator.presentation.presenter import Control, Presenter, ViewUpdate
from rastrainer_simulator.presentation.screen import Screen, without_secrets
from rastrainer_simulator.scene.scene_files import SceneFiles
from rastrainer_simulator.state import SimulationState
from rastrainer_simulator.vectors import vector
from rastrainer_simulator.viewpoint.arm_cover import ArmCover, places_to_see
from rastrainer_simulator.viewpoint.best_view import load_marks
from rastrainer_simulator.viewpoint.view_control import Pictures

_log = logging.getLogger(__name__)

STATE_HZ, SEAT_HZ = 60.0, 5.0
_WATCH_PERIOD_S = 0.05
_BEFORE_BUILDING_AHEAD_S = 3.0
ENDING = "The simulator has been stopped."


class JoinedViews:
    """The joined views; `is_due` may be called in any thread, all else in the event loop's."""

    def __init__(
        self, source: StateSource, presenter: Presenter, scenes: SceneFiles, limits: ViewLimits
    ) -> None:
        self._source = source
        self._presenter = presenter
        self._scenes = scenes
        self._limits = limits
        self._views: dict[int, ViewSocket] = {}
        self._boards: dict[int, ViewSocket] = {}
        self._seat = ""
        self._seat_pacer = Pacer(SEAT_HZ)
        self._numbers = itertools.count(1)
        self._pacer = Pacer(STATE_HZ)
        self._setup: SimulationSetup | None = None
        self._task = ""
        self._scene = ""
        self._pairing = ""
        self._trace = TraceUpdate()
        self._cover: ArmCover | None = None
        self._loading: asyncio.Task[None] | None = None
        self._watching: asyncio.Task[None] | None = None
        self._unsubscribe = presenter.updates.add(self._send_update)

    async def serve(self, stream: web.WebSocketResponse, hello: Hello, is_local: bool) -> None:
        """Have a view take part, or a spectator or a board watch, until it leaves."""
        view = ViewSocket(next(self._numbers), stream, hello, self._presenter, is_local)
        is_board = hello.kind == "board"
        if is_board:
            # First the others: then all know the same, and the new one receives nothing twice.
            self._tell_boards(self._source.latest)
        joined = self._boards if is_board else self._views
        joined[view.number] = view
        try:
            if not view.is_spectator:
                self._presenter.view_joined(view.number, hello)
            welcome = WelcomeNews(PROTOCOL, view.number, () if is_board else BODIES)
            view.outbox.put_latest(WelcomeNews.type, message_text(welcome))
            if is_board:
                view.outbox.put_latest(SeatNews.type, self._seat)
            else:
                self._send_all(view)
            if self._watching is None:
                self._watching = asyncio.create_task(self._release_silent())
            await view.serve()
        finally:
            view.held.release()
            del joined[view.number]
            if not view.is_spectator:
                self._presenter.view_left(view.number)

    def announce_pairing(self, code: str, addresses: Sequence[str]) -> None:
        """Send the views of this computer how others are paired, now and whenever one joins."""
        self._pairing = message_text(PairingNews(code, tuple(addresses)))
        for view in self._views.values():
            self._put_pairing(view)

    async def close(self) -> None:
        self._unsubscribe()
        tasks = [task for task in (self._loading, self._watching) if task is not None]
        for task in tasks:
            task.cancel()
        everyone = (*self._views.values(), *self._boards.values())
        closings = [view.close(WSCloseCode.GOING_AWAY, ENDING) for view in everyone]
        await asyncio.gather(*tasks, *closings, return_exceptions=True)

    def is_due(self, _state: SimulationState) -> bool:
        return bool(self._views or self._boards) and self._pacer.is_due(time.monotonic())

    def tell(self, now: SimulationState) -> None:
        """Send the moving bodies, and check whether another scene is needed."""
        if self._boards and self._seat_pacer.is_due(time.monotonic()):
            self._tell_boards(now)
        if not self._views:
            return
        self._look_for_scene(now)
        self._send_state(now, self._views.values())
        news = self._trace.news(now, self._presenter.trace_guidance(now), time.monotonic())
        if news is not None:
            text = message_text(news)
            for view in self._views.values():
                view.outbox.put_event(text)

    def _tell_boards(self, now: SimulationState) -> None:
        text = seat_text(now, self._presenter.seat())
        if text != self._seat:
            self._seat = text
            for board in self._boards.values():
                board.outbox.put_latest(SeatNews.type, text)

    def _send_all(self, view: ViewSocket) -> None:
        now = self._source.latest
        self._look_for_scene(now)
        if self._scene:
            view.outbox.put_latest(SceneNews.type, self._scene)
        _put_control(view, self._presenter.control)
        self._send_screen(self._presenter.screen, (view,))
        self._send_state(now, (view,))
        trace = self._trace.everything()
        if trace is not None:
            view.outbox.put_event(message_text(trace))
        self._put_pairing(view)

    def _send_state(self, now: SimulationState, views: Iterable[ViewSocket]) -> None:
        statistics, presenter = self._source.statistics, self._presenter
        pictures = presenter.pictures(now)
        news = state_news(
            now,
            statistics.late + statistics.skipped,
            pictures,
            self._covering(now, pictures),
            presenter.ghost(now),
        )
        # Only spectators are sent the headset's pose.
        whole, text = "", message_text(news)
        for view in views:
            if view.is_spectator and not whole:
                whole = message_text(dataclasses.replace(news, headset=self._headset_pose()))
            view.outbox.put_latest(StateNews.type, whole if view.is_spectator else text)

    def _put_pairing(self, view: ViewSocket) -> None:
        # A spectator who knew the code could come back as a driver.
        if view.is_local and self._pairing and not view.is_spectator:
            view.outbox.put_latest(PairingNews.type, self._pairing)

    def _headset_pose(self) -> HeadsetPose | None:
        """Return the newest headset's pose; a headset that reconnects is another view."""
        headsets = [view for view in self._views.values() if view.hello.kind == "headset"]
        return headsets[-1].headset_pose if headsets else None

    def _covering(self, now: SimulationState, pictures: Pictures) -> CoveringBodies:
        setup = self._source.setup
        if self._cover is None or self._cover.setup is not setup:
            self._cover = ArmCover(setup)
        pose = self._headset_pose()
        eyes = {
            "view": pictures.main.position,
            "inset": None if pictures.inset is None else pictures.inset.position,
            "headset": vector(pose.eyes[:3]) if pose and pose.eyes else None,
        }
        guided = self._presenter.trace_guidance(now).next_place
        places = places_to_see(now, setup.scenario, None if guided is None else guided.position_mm)
        return CoveringBodies(**self._cover.covering(now, eyes, places))

    def _send_update(self, update: ViewUpdate) -> None:
        views, screen = self._views.values(), self._presenter.screen
        if isinstance(update, Screen):
            self._send_screen(update, views)
        elif isinstance(update, Feedback):
            text = message_text(update)
            for view in views:
                # How often the focus clicks says which item was chosen.
                if not screen.is_private or self._is_operators(view):
                    view.outbox.put_event(text)
        elif isinstance(update, Control):
            for view in views:
                _put_control(view, update)
            if screen.is_private:
                self._send_screen(screen, views)

    def _send_screen(self, screen: Screen, views: Iterable[ViewSocket]) -> None:
        """Send a screen; private parts only to the operator's views."""
        whole = screen_text(screen)
        bare = screen_text(without_secrets(screen)) if screen.is_private else whole
        for view in views:
            is_whole = not screen.is_private or self._is_operators(view)
            view.outbox.put_latest(ScreenNews.type, whole if is_whole else bare)

    def _is_operators(self, view: ViewSocket) -> bool:
        if view.is_spectator:
            return False
        number = self._presenter.control.view
        holding = None if number is None else self._views.get(number)
        # A gamepad at the simulator, and each of its windows, belongs to all of these windows.
        is_own = number is None or (holding is not None and holding.hello.kind == "desktop")
        return view is holding or (is_own and view.hello.kind == "desktop")

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
            news = scene_news(file.sha256, setup.scenario, task, setup.settings.axes)
            self._scene = message_text(news)
            for view in self._views.values():
                view.outbox.put_latest(SceneNews.type, self._scene)
            await asyncio.to_thread(load_marks)
            # The views that have just got this scene need the processor first.
            await asyncio.sleep(_BEFORE_BUILDING_AHEAD_S)
            await self._scenes.build_all(setup)
        except InputError as error:
            _log.error("%s", error)

    async def _release_silent(self) -> None:
        while True:
            await asyncio.sleep(_WATCH_PERIOD_S)
            for view in tuple(self._views.values()):
                view.check_silence(self._limits.silent_s, self._limits.lost_s)


def _put_control(view: ViewSocket, control: Control) -> None:
    news = ControlNews(control.holder, control.view == view.number)
    view.outbox.put_latest(ControlNews.type, message_text(news))
