"""Serves a trial that is shown again to the simulator's views, until somebody has seen enough."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.journal.journal_reader import read_journal
from rastrainer.protocol import DEFAULT_HOST
from rastrainer_simulator.controls.config_folder import config_folder
from rastrainer_simulator.desktop_process import DesktopProcess
from rastrainer_simulator.flow.preferences import FILE_NAME, Preferences, read_preferences
from rastrainer_simulator.logs.log_folder import log_folder
from rastrainer_simulator.record.recorded_setup import setup_of
from rastrainer_simulator.replaying.film import make_film
from rastrainer_simulator.replaying.replay_desk import ReplayDesk
from rastrainer_simulator.replaying.replay_loop import ReplayLoop
from rastrainer_simulator.server import stop_on_signals
from rastrainer_simulator.view_server.open_views import open_views


def show(
    journal: Path, scenario: Path | None, port: int | None, has_window: bool, tell: Callable
) -> None:
    """Show a journal's trial to views until the window is closed, Escape or Ctrl-C is pressed.

    Raises:
        InputError: it cannot be replayed, or the port not be listened on.
    """
    reading = read_journal(journal)
    setup = setup_of(reading.header, scenario)
    loop = ReplayLoop(make_film(reading, setup), setup)
    asyncio.run(_serve(loop, port, has_window, tell))


async def _serve(loop: ReplayLoop, port: int | None, has_window: bool, tell: Callable) -> None:
    stop = asyncio.Event()
    desk = ReplayDesk(loop, _language(), stop.set)
    window: DesktopProcess | None = None
    tasks: list[asyncio.Task[None]] = []
    with stop_on_signals(asyncio.get_running_loop(), stop):
        views = await open_views(loop, desk, tell, port, None)
        try:
            tasks.append(asyncio.create_task(loop.run()))
            if has_window:
                window = DesktopProcess(
                    f"http://{DEFAULT_HOST}:{views.port}", views.sessions.open(), log_folder()
                )
                tasks.append(asyncio.create_task(window.run(stop.set, tell)))
            await stop.wait()
        finally:
            for task in tasks:
                task.cancel()
            if window is not None:
                await window.close()
            await views.close()


def _language() -> str:
    with contextlib.suppress(InputError):
        return read_preferences(config_folder() / FILE_NAME).language
    return Preferences().language
