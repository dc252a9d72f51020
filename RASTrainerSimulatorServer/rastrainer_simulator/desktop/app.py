"""The window's process: events in, messages out, and the latest state as picture and sounds."""

from __future__ import annotations

import asyncio
import contextlib
import json
import logging
import os
import time
from collections.abc import Callable, Coroutine, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import IO, Any

import pygame

from rastrainer.errors import InputError
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.desktop.connection import ServerConnection
from rastrainer_simulator.desktop.gl_window import GlWindow
from rastrainer_simulator.desktop.inbox import Inbox
from rastrainer_simulator.desktop.keyboard_and_mouse import (
    LEFT_BUTTON,
    MouseSticks,
    OperatorKeys,
    ViewMouse,
    key_names,
    without_late_repeats,
)
from rastrainer_simulator.desktop.picture import Picture
from rastrainer_simulator.desktop.screenshot import (
    Screenshot,
    picture_path,
    save_screenshot,
    write_picture,
)
from rastrainer_simulator.desktop.viewports import Quality, first_quality
from rastrainer_simulator.presentation.messages import Frames, ItemInput

POLL_S = 0.004
"""How often the window polls the keyboard while nothing arrives."""
LEAST_REFRESH_HZ = 60.0
MIN_PAUSE_S = 0.002
"""Between two pictures, however slow: the messages that have arrived are processed by then."""
TRIED_FRAMES = 12
SLOWEST_FRAME_S = 1.0 / 45.0
"""Where pictures take longer, the quality is lowered."""
SOFTWARE_SIZE = (1280, 720)
"""A processor of two cores draws 20 pictures a second of this size; docs/design.md has numbers."""
NICENESS = 10
REPORT_EVERY_S = 1.0
OWN_KEYS = (pygame.K_F11, pygame.K_F12)
"""Full screen, and screenshot: these are not sent to the simulator."""

_log = logging.getLogger(__name__)
STANDARD_ERROR = 2
CHANNELS = 8
BUFFER_SAMPLES = 512


@dataclass(frozen=True)
class WindowOptions:
    """What the window is started with.

    Attributes:
        url: of the simulator, such as "http://127.0.0.1:18945".
        key: that the simulator knows.
        pictures: folder of what F12 keeps.
        size: in pixels; None for one that suits the display.
        is_fullscreen: whether to begin without a frame.
        quality: None finds out what the machine can afford.
        picture_quality: of what F12 keeps; another process draws it where it is not what is shown.
        frame_log: file that gets a line for each picture, for measurements.
    """

    url: str
    key: str
    pictures: Path
    size: tuple[int, int] | None = None
    is_fullscreen: bool = False
    quality: Quality | None = None
    picture_quality: Quality = Quality.HIGH
    frame_log: Path | None = None


class DesktopWindow:
    """Runs until the user closes it."""

    def __init__(self, options: WindowOptions):
        """Open the window.

        Raises:
            RASTrainerError: there is no display.
        """
        self._options = options
        self._window = GlWindow(options.size, options.is_fullscreen)
        self._sounds = Sounds()
        self._inbox = Inbox()
        quality = options.quality or first_quality(self._window.renderer_name)
        if quality is Quality.LOW:
            # It draws with the processor that the control loop needs on time.
            _lower_priority()
            if options.size is None:
                self._window.shrink_to(SOFTWARE_SIZE)
        self._picture = Picture(self._window, self._inbox, quality)
        self._frame_times: list[float] | None = [] if options.quality is None else None
        self._connection = ServerConnection(
            options.url, options.key, self._inbox, self._window.refresh_hz
        )
        self._keys = OperatorKeys(self._connection)
        self._view_mouse = ViewMouse(self._connection)
        self._mouse_sticks = MouseSticks(self._connection)
        self._frames = FrameCount(self._report_frames, time.monotonic())
        self._own_held: set[int] = set()
        self._screenshots: set[asyncio.Task[None]] = set()
        self._one_screenshot = asyncio.Lock()
        self._is_open = True
        self._name_keys()

    async def run(self) -> None:
        """Draw and listen until the window is closed."""
        connecting = asyncio.create_task(self._connection.run())
        try:
            with self._open_log() as log:
                while self._is_open and not connecting.done():
                    await self._step(log)
        finally:
            connecting.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await connecting
            await asyncio.gather(*self._screenshots)
            self._sounds.close()
            self._window.close()

    async def _step(self, log: IO[str] | None) -> None:
        """Process what has arrived, and draw it if it is visible."""
        begin = time.monotonic()
        for event in without_late_repeats(pygame.event.get(), self._keys.is_held):
            self._take(event)
        self._keys.keep_alive()
        self._mouse_sticks.keep_alive()
        self._show_sticks()
        self._view_mouse.tell(not self._has_menu)
        while self._inbox.sounds:
            sound = self._inbox.sounds.popleft()
            self._sounds.play(sound.name, sound.volume)
        is_due = self._picture.is_due(begin)
        if not is_due:
            self._frames.report(begin)
            await self._inbox.wait(POLL_S)
            return
        self._frames.due()
        if self._picture.draw():
            # They were made while the previous picture was still visible.
            pygame.event.clear(pygame.MOUSEBUTTONDOWN)
        self._frames.shown()
        if self._inbox.scene is not None and not self._inbox.problem:
            self._connection.tell_drawn(self._inbox.scene.task)
        self._log_frame(log)
        self._lower_quality_if_slow(time.monotonic() - begin)
        self._frames.report(begin)
        rest = begin + 1.0 / max(LEAST_REFRESH_HZ, self._window.refresh_hz) - time.monotonic()
        # Not drawn faster than it can be seen; what arrives meanwhile is processed.
        await asyncio.sleep(max(MIN_PAUSE_S, rest))

    def _take(self, event: pygame.event.Event) -> None:
        if event.type in (pygame.KEYDOWN, pygame.KEYUP) and event.key in OWN_KEYS:
            self._take_own_key(event)
            return
        if event.type == pygame.QUIT:
            self._is_open = False
        elif event.type == pygame.MOUSEMOTION and event.rel != (0, 0):
            self._picture.pointer.move(event.pos, time.monotonic())
            self._mouse_sticks.take(event, self._window.size)
        elif self._picture.has_sticks and self._mouse_sticks.take(event, self._window.size):
            self._picture.pointer.move(event.pos, time.monotonic())
        elif event.type == pygame.MOUSEBUTTONDOWN and event.button == LEFT_BUTTON:
            self._click(event.pos)
        elif event.type == pygame.MOUSEWHEEL and event.y and self._has_menu:
            self._keys.tap("ArrowUp" if event.y > 0 else "ArrowDown")
        elif event.type in (pygame.WINDOWEXPOSED, pygame.WINDOWSIZECHANGED):
            self._picture.redraw()
        elif event.type == pygame.KEYMAPCHANGED:
            self._name_keys()
        self._view_mouse.take(event, self._window.size[1])
        self._keys.take(event)

    def _name_keys(self) -> None:
        """Name the keys as the keyboard in use has them, here and in the simulator's sentences."""
        names = key_names()
        self._connection.name_keys(names)
        self._picture.name_keys(names)

    def _show_sticks(self) -> None:
        """Have the sticks drawn as deflected; those that are not shown are released."""
        if not self._picture.has_sticks:
            self._mouse_sticks.release()
        self._picture.pushes = self._mouse_sticks.pushes

    @property
    def _has_menu(self) -> bool:
        screen = self._inbox.screen
        return screen is not None and screen.menu is not None

    def _take_own_key(self, event: pygame.event.Event) -> None:
        """Carry out a key of the window, once for as long as it is held."""
        if event.type == pygame.KEYUP:
            self._own_held.discard(event.key)
        elif event.key not in self._own_held:
            self._own_held.add(event.key)
            if event.key == pygame.K_F11:
                self._window.toggle_fullscreen()
            else:
                self._save_screenshot()

    def _click(self, place: tuple[int, int]) -> None:
        now = time.monotonic()
        self._picture.pointer.move(place, now)
        name = self._picture.item_to_choose(now)
        if name:
            self._connection.send(ItemInput(name))

    def _save_screenshot(self) -> None:
        """Save what is shown now, while the window keeps running."""
        path = picture_path(self._options.pictures)
        best = self._options.picture_quality
        if best is self._picture.viewports.quality:
            keep = asyncio.to_thread(write_picture, self._window.pixels(), path)
        else:
            keep = save_screenshot(Screenshot.of(self._inbox, path, self._window.size, best))
        keeping = asyncio.create_task(self._keep(keep, path))
        self._screenshots.add(keeping)
        keeping.add_done_callback(self._screenshots.discard)

    async def _keep(self, keep: Coroutine[Any, Any, None], path: Path) -> None:
        """Save a picture after the previous ones."""
        try:
            async with self._one_screenshot:
                await keep
        except InputError as error:
            _log.warning("%s", error)
        else:
            print(f"Picture {path}", flush=True)

    def _lower_quality_if_slow(self, seconds: float) -> None:
        """Lower the quality where the machine turns out to be too slow."""
        if self._frame_times is None or self._inbox.scene is None:
            return
        self._frame_times.append(seconds)
        if len(self._frame_times) < TRIED_FRAMES:
            return
        # The first pictures also compile what draws them.
        median = sorted(self._frame_times[TRIED_FRAMES // 2 :])[TRIED_FRAMES // 4]
        quality = self._picture.viewports.quality
        if median <= SLOWEST_FRAME_S or quality is Quality.LOW:
            self._frame_times = None
        else:
            self._frame_times = []
            self._picture.set_quality(quality.next_lower)

    def _report_frames(self, shown: int, dropped: int) -> None:
        hz = self._window.refresh_hz
        self._connection.send(Frames(shown, dropped, hz))

    def _open_log(self) -> contextlib.AbstractContextManager[IO[str] | None]:
        path = self._options.frame_log
        return contextlib.nullcontext() if path is None else path.open("w", encoding="utf-8")

    def _log_frame(self, log: IO[str] | None) -> None:
        if log is None or self._inbox.state is None or self._inbox.scene is None:
            return
        quality = self._picture.viewports.quality.value
        line = {"shown": time.monotonic(), "tick": self._inbox.state.tick, "quality": quality}
        log.write(json.dumps(line) + "\n")
        log.flush()


def _lower_priority() -> None:
    """Leave the processor to the simulator: on Linux each thread has its own priority."""
    if not hasattr(os, "setpriority"):
        return
    tasks = Path("/proc/self/task")
    threads = [int(task.name) for task in tasks.iterdir()] if tasks.exists() else [0]
    ordinary = os.getpriority(os.PRIO_PROCESS, 0)
    for thread in threads:
        with contextlib.suppress(OSError):  # It may have ended.
            # Threads with their own priority, such as SDL's sound, keep it.
            if os.getpriority(os.PRIO_PROCESS, thread) == ordinary:
                os.setpriority(os.PRIO_PROCESS, thread, max(ordinary, NICENESS))


class FrameCount:
    """Counts the pictures of each second, and those that were due and did not come."""

    def __init__(self, report: Callable[[int, int], None], now: float):
        """`report` is called once a second with how many were shown and how many dropped."""
        self._on_second = report
        self._since = now
        self._shown = self._due = 0

    def due(self) -> None:
        """Note that something to be drawn has arrived."""
        self._due += 1

    def shown(self) -> None:
        """Note that a picture with all that has arrived was drawn."""
        self._shown += 1

    def report(self, now: float) -> None:
        if now - self._since >= REPORT_EVERY_S:
            self._on_second(self._shown, max(0, self._due - self._shown))
            self._since, self._shown, self._due = now, 0, 0


@contextlib.contextmanager
def _silent_libraries() -> Iterator[None]:
    """Discard what libraries in C print: without a sound card, ALSA repeats in eight lines why."""
    try:
        kept = os.dup(STANDARD_ERROR)
    except OSError:  # A program without a terminal may have none.
        yield
        return
    with Path(os.devnull).open("wb") as nothing:
        os.dup2(nothing.fileno(), STANDARD_ERROR)
    try:
        yield
    finally:
        os.dup2(kept, STANDARD_ERROR)
        os.close(kept)


class Sounds:
    """The loudspeaker; silent where there is none."""

    def __init__(self) -> None:
        self._sounds: dict[str, pygame.mixer.Sound] = {}
        try:
            with _silent_libraries():
                pygame.mixer.init(buffer=BUFFER_SAMPLES)
        except pygame.error as error:
            _log.warning("There will be no sound: %s", error)
            return
        pygame.mixer.set_num_channels(CHANNELS)
        for path in sorted(asset_path("sounds").glob("*.wav")):
            self._sounds[path.stem] = pygame.mixer.Sound(path)

    @property
    def names(self) -> Iterable[str]:
        return self._sounds.keys()

    def play(self, name: str, volume: float) -> bool:
        """Play a sound at a volume from 0 to 1; return whether it can be heard."""
        sound = self._sounds.get(name)
        if sound is None or volume <= 0.0:
            return False
        channel = sound.play()
        if channel is None:
            return False
        channel.set_volume(min(1.0, volume))
        return True

    def close(self) -> None:
        """Release the loudspeaker."""
        pygame.mixer.quit()
