"""Serve recorded trials to the simulator's views: one, or those that a rater judges."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.journal.folder import journals_of
from rastrainer.journal.recording import find_track, read_track
from rastrainer.protocol import DEFAULT_HOST, TRIAL_RUN
from rastrainer.study.database.study import Study
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.flow.session.preferences import (
    PREFERENCES_FILE,
    Preferences,
    read_preferences,
)
from rastrainer_simulator.loop.results import StateSource
from rastrainer_simulator.net.views.view_server import ViewServer
from rastrainer_simulator.ops.application_window import ApplicationWindow
from rastrainer_simulator.ops.processes import stop_on_signals
from rastrainer_simulator.ops.system_paths import config_folder
from rastrainer_simulator.presentation.presenter import Presenter
from rastrainer_simulator.rating.rating_presenter import RatingPresenter
from rastrainer_simulator.rating.rating_work import RatingWork
from rastrainer_simulator.record.trial_context import setup_of
from rastrainer_simulator.replay.playback import Playback, play_on
from rastrainer_simulator.replay.recorded_trial import RecordedTrial
from rastrainer_simulator.replay.replay_presenter import ReplayPresenter


def show(
    journal: Path, scenario: Path | None, port: int | None, has_window: bool, announce: Callable
) -> None:
    """Show a journal's trial to views until the window is closed, Escape or Ctrl-C is pressed."""
    track = read_track(journal)
    setup = setup_of(track.header, scenario)
    playback = Playback(RecordedTrial(track, setup), setup)

    async def serve() -> None:
        stop = asyncio.Event()
        presenter = ReplayPresenter(playback, _preferred_language(), stop.set)
        await _show_until(stop, playback, presenter, playback.advance, port, has_window, announce)

    asyncio.run(serve())


async def _show_until(
    stop: asyncio.Event,
    source: StateSource,
    presenter: Presenter,
    advance: Callable[[float], None],
    port: int | None,
    has_window: bool,
    announce: Callable,
) -> None:
    """Show a playback to views, and in its own window if wanted, until `stop` is set.

    `advance` plays it on by some s; `port` None is the usual one.
    """
    window: ApplicationWindow | None = None
    tasks: list[asyncio.Task[None]] = []
    with stop_on_signals(stop):
        views = ViewServer(source, presenter, announce)
        try:
            await views.start(port)
            tasks.append(asyncio.create_task(play_on(advance)))
            if has_window:
                window = ApplicationWindow(f"http://{DEFAULT_HOST}:{views.port}", views.code.code)
                tasks.append(asyncio.create_task(window.run(stop.set, announce)))
            await stop.wait()
        finally:
            for task in tasks:
                task.cancel()
            if window is not None:
                await window.close()
            await views.close()


def _preferred_language() -> str:
    with contextlib.suppress(InputError):
        return read_preferences(config_folder() / PREFERENCES_FILE).language
    return Preferences().language


def trials_to_show(study: Study, records: Path) -> tuple[str, ...]:
    """Return the finished trials of consenting trainees whose journals are in a folder.

    Trial runs are practice, and are left out.
    """
    everyone = study.trainees(archived=None)
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
            "who consented to research."
        )
    return found


@dataclass
class ReplayLoader:
    """Loads the replays of trials; trials of one set-up share it, and views load its scene once."""

    records: Path
    scenario: Path | None
    _setups: dict[str, SimulationSetup] = field(default_factory=dict)

    def load(self, trial_id: str) -> Playback:
        """Return the playback of a trial; takes seconds. Never in two threads at once."""
        try:
            track = find_track(self.records, trial_id)
            header = track.header
            same = header.scenario, header.robot, header.settings, header.procedure, header.method
            key = repr(same)
            if key not in self._setups:
                self._setups[key] = setup_of(track.header, self.scenario)
            setup = self._setups[key]
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
    """Show the replays of a rater to views, and accept the marks, until the rater leaves."""
    loader = ReplayLoader(records, scenario)
    with ThreadPoolExecutor(1, "replay") as worker:

        def load(trial_id: str) -> Future[Playback]:
            return worker.submit(loader.load, trial_id)

        async def serve() -> None:
            stop = asyncio.Event()
            presenter = RatingPresenter(work, first, load, _preferred_language(), stop.set)

            def advance(seconds: float) -> None:
                if presenter.shown.playback is not None:
                    presenter.shown.playback.advance(seconds)
                presenter.advance(seconds)

            await _show_until(stop, presenter.shown, presenter, advance, port, has_window, announce)

        first = load(work.trial_id).result()
        asyncio.run(serve())
