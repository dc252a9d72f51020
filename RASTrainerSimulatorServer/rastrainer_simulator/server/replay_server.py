"""Serves a recorded trial to the simulator's views until a user ends it."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable, Coroutine
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.journal.recording import read_track
from rastrainer.protocol import DEFAULT_HOST
from rastrainer_simulator.flow.session.preferences import (
    PREFERENCES_FILE,
    Preferences,
    read_preferences,
)
from rastrainer_simulator.net.state_feed import StateSource
from rastrainer_simulator.net.views.open_views import open_views
from rastrainer_simulator.net.views.presenter import Presenter
from rastrainer_simulator.ops.chinese_font import has_letters
from rastrainer_simulator.ops.folders import config_folder, log_folder
from rastrainer_simulator.ops.processes import DesktopProcess, stop_on_signals
from rastrainer_simulator.record.recorded_setup import setup_of
from rastrainer_simulator.replay.playback import Playback
from rastrainer_simulator.replay.recorded_trial import RecordedTrial
from rastrainer_simulator.replay.replay_presenter import ReplayPresenter


def show(
    journal: Path, scenario: Path | None, port: int | None, has_window: bool, announce: Callable
) -> None:
    """Show a journal's trial to views until the window is closed, Escape or Ctrl-C is pressed.

    Raises:
        InputError: it cannot be shown, or the port cannot be listened on.
    """
    track = read_track(journal)
    setup = setup_of(track.header, scenario)
    playback = Playback(RecordedTrial(track, setup), setup)
    asyncio.run(_serve(playback, port, has_window, announce))


async def _serve(
    playback: Playback, port: int | None, has_window: bool, announce: Callable
) -> None:
    stop = asyncio.Event()
    presenter = ReplayPresenter(playback, preferred_language(), stop.set)
    await show_until(stop, playback, presenter, playback.run, port, has_window, announce)


async def show_until(
    stop: asyncio.Event,
    source: StateSource,
    presenter: Presenter,
    run: Callable[[], Coroutine[Any, Any, None]],
    port: int | None,
    has_window: bool,
    announce: Callable,
) -> None:
    """Show what is played to views, and to a window of its own if wanted, until it shall stop.

    Args:
        stop: is set by whoever ends it: the presenter, the closed window, or a signal.
        source: the states that are shown.
        presenter: what is read beside them.
        run: plays them until it is canceled.
        port: where views are served; None for the usual one.
        has_window: whether a window is opened.
        announce: says where views are served.

    Raises:
        InputError: the port cannot be listened on.
    """
    window: DesktopProcess | None = None
    tasks: list[asyncio.Task[None]] = []
    with stop_on_signals(stop):
        views = await open_views(source, presenter, announce, port, None)
        try:
            tasks.append(asyncio.create_task(run()))
            if has_window:
                window = DesktopProcess(
                    f"http://{DEFAULT_HOST}:{views.port}", views.sessions.open(), log_folder()
                )
                tasks.append(asyncio.create_task(window.run(stop.set, announce)))
            await stop.wait()
        finally:
            for task in tasks:
                task.cancel()
            if window is not None:
                await window.close()
            await views.close()


def preferred_language() -> str:
    """Return the language of the user's settings, a BCP 47 tag, if a window can show it here."""
    with contextlib.suppress(InputError):
        language = read_preferences(config_folder() / PREFERENCES_FILE).language
        if has_letters(language):
            return language
    return Preferences().language
