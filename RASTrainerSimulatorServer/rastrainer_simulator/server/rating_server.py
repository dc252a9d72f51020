"""Serves replays and rating forms to the simulator's views until the rater leaves."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.journal.folder import journals_of
from rastrainer.journal.replay_track import find_track
from rastrainer.protocol import DEFAULT_HOST, TRIAL_RUN
from rastrainer.study.database.study import Study
from rastrainer.study.rating.rating_work import RatingWork
from rastrainer_simulator.net.views.open_views import open_views
from rastrainer_simulator.ops.desktop_process import DesktopProcess
from rastrainer_simulator.ops.folders import log_folder
from rastrainer_simulator.rating.rating_presenter import RatingPresenter
from rastrainer_simulator.record.recorded_setup import setup_of
from rastrainer_simulator.replay.playback import Playback
from rastrainer_simulator.replay.recorded_trial import RecordedTrial
from rastrainer_simulator.server.replay_server import preferred_language
from rastrainer_simulator.server.server import stop_on_signals


def trials_to_show(study: Study, records: Path) -> tuple[str, ...]:
    """Return the finished trials of consenting trainees whose journals are in a folder.

    Trial runs are practice, and are left out.

    Raises:
        InputError: there are none.
    """
    everyone = (*study.trainees(), *study.trainees(archived=True))
    found = tuple(
        stored.record.trial_id
        for trainee in everyone
        if trainee.consent
        for stored in study.history(trainee.pseudonym)
        if stored.record.task != TRIAL_RUN and journals_of(records, stored.record.trial_id)
    )
    if not found:
        raise InputError(
            f"There is nothing to rate: {records} has no journal of a finished trial of a trainee "
            "who agreed to research."
        )
    return found


def load_replay(records: Path, scenario: Path | None, trial_id: str) -> Playback:
    """Return the playback of a trial; takes seconds.

    Raises:
        InputError: it cannot be shown.
    """
    try:
        track = find_track(records, trial_id)
        setup = setup_of(track.header, scenario)
        return Playback(RecordedTrial(track, setup), setup)
    except InputError as error:
        # Its own sentences may name the journal, and with it the trial.
        raise InputError(
            "This replay cannot be shown: its journal is damaged, or was recorded with another "
            "scenario, whose folder is given with --scenario."
        ) from error


def serve_rating(
    work: RatingWork,
    records: Path,
    scenario: Path | None,
    port: int | None,
    has_window: bool,
    announce: Callable[[str], None],
) -> None:
    """Show the replays of a rater to views, and take the marks, until the rater leaves.

    Raises:
        InputError: the first replay cannot be shown, or the port cannot be listened on.
    """
    with ThreadPoolExecutor(1, "replay") as worker:

        def load(trial_id: str):
            return worker.submit(load_replay, records, scenario, trial_id)

        first = load(work.trial_id).result()
        asyncio.run(_serve(work, first, load, port, has_window, announce))


async def _serve(
    work: RatingWork,
    first: Playback,
    load: Callable,
    port: int | None,
    has_window: bool,
    announce: Callable[[str], None],
) -> None:
    stop = asyncio.Event()
    presenter = RatingPresenter(work, first, load, preferred_language(), stop.set)
    window: DesktopProcess | None = None
    tasks: list[asyncio.Task[None]] = []
    with stop_on_signals(asyncio.get_running_loop(), stop):
        views = await open_views(presenter.shown, presenter, announce, port, None)
        try:
            tasks.append(asyncio.create_task(presenter.shown.run(presenter.advance)))
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
