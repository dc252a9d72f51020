"""Serves a recorded trial to the simulator's views until a user ends it."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.journal.replay_track import read_track
from rastrainer.protocol import DEFAULT_HOST
from rastrainer_simulator.flow.session.preferences import (
    PREFERENCES_FILE,
    Preferences,
    read_preferences,
)
from rastrainer_simulator.net.views.open_views import open_views
from rastrainer_simulator.ops.desktop_process import DesktopProcess
from rastrainer_simulator.ops.folders import config_folder, log_folder
from rastrainer_simulator.record.recorded_setup import setup_of
from rastrainer_simulator.replay.playback import Playback
from rastrainer_simulator.replay.recorded_trial import RecordedTrial
from rastrainer_simulator.replay.replay_presenter import ReplayPresenter
from rastrainer_simulator.server.server import stop_on_signals


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
    window: DesktopProcess | None = None
    tasks: list[asyncio.Task[None]] = []
    with stop_on_signals(asyncio.get_running_loop(), stop):
        views = await open_views(playback, presenter, announce, port, None)
        try:
            tasks.append(asyncio.create_task(playback.run()))
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
    """Return the language of the user's settings, a BCP 47 tag."""
    with contextlib.suppress(InputError):
        return read_preferences(config_folder() / PREFERENCES_FILE).language
    return Preferences().language
