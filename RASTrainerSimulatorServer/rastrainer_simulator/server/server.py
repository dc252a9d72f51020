"""The simulator's process: the control loop, its clients and the clean end of both."""

from __future__ import annotations

import asyncio
import contextlib
import gc
import itertools
import logging
import os
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.random import default_rng

from rastrainer.commands import CommandName
from rastrainer.errors import InputError, RASTrainerError
from rastrainer.journal.journal_file import JournalReading
from rastrainer.protocol import DEFAULT_HOST, DEFAULT_PORT
from rastrainer.python_environment import temporary_environment
from rastrainer.scenario.scenario import task_by_method
from rastrainer.study_messages import CurriculumMessage, StudyStep
from rastrainer_simulator.core.interrupted_trial import find_interrupted
from rastrainer_simulator.core.settings import SimulationSettings
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.flow.session.assigned_training import AssignedTraining
from rastrainer_simulator.flow.session.preferences import PREFERENCES_FILE, read_preferences
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.loop.results import StateFeed, trial_log
from rastrainer_simulator.loop.timing import raise_thread_priority
from rastrainer_simulator.net.igtl.simulator_link import SimulatorLink
from rastrainer_simulator.net.limits import read_limits
from rastrainer_simulator.net.listener import is_loopback
from rastrainer_simulator.ops.application_window import ApplicationWindow
from rastrainer_simulator.ops.instructor_pin import InstructorPin
from rastrainer_simulator.ops.processes import stop_on_signals
from rastrainer_simulator.ops.system_paths import config_folder
from rastrainer_simulator.record.journal_writer import RecordsFolder
from rastrainer_simulator.record.trial_context import setup_of, versions
from rastrainer_simulator.robot.kinematics import kinematics_name
from rastrainer_simulator.server.scenario_loader import ScenarioLoader
from rastrainer_simulator.state import Answer, answered

if TYPE_CHECKING:
    from rastrainer_simulator.flow.running_presenter import RunningPresenter
    from rastrainer_simulator.net.views.view_server import ViewServer

_log = logging.getLogger(__name__)

_LOOP_CHECK_PERIOD_S = 1.0


@dataclass(frozen=True)
class ServerOptions:
    """The options of the simulator.

    The `seed` determines the heads' poses; `is_seeded` is whether it was chosen, not drawn. A port
    0 is any free port; a `view_port` None is the usual port if it is free. `connect_to` is a
    listening Slicer, in place of listening. With `has_network`, other computers may show views,
    too; with `has_desktop`, the simulator ends when its window is closed; with `scores_alone`, it
    scores trials outside of a study if no Slicer is connected.
    """

    records: Path
    seed: int
    is_seeded: bool = False
    host: str = DEFAULT_HOST
    port: int = DEFAULT_PORT
    connect_to: tuple[str, int] | None = None
    speed: float = 1.0
    scenario: Path | None = None
    robot_meshes: Path | None = None
    view_port: int | None = None
    has_views: bool = True
    has_network: bool = False
    has_gamepad: bool = True
    has_desktop: bool = False
    config: Path | None = None
    resumes: bool = True
    scores_alone: bool = True


class SimulatorServer:
    """One simulation with its clients and views."""

    def __init__(self, options: ServerOptions):
        """Load the scenario and the robot, which takes about a second."""
        self._options = options
        self._config = options.config or config_folder()
        self._limits = read_limits(self._config)
        self._settings = SimulationSettings()
        if options.has_views:
            # The presenter reads the file again, and reports that it is missing or invalid.
            with contextlib.suppress(InputError):
                preferences = read_preferences(self._config / PREFERENCES_FILE)
                self._settings = preferences.applied_to(self._settings)
        self._seeds = itertools.count(options.seed)
        self._assigned = AssignedTraining()
        self._pin = InstructorPin(self._config)
        # First: until the folder is ours, another simulator may add to the trial to resume.
        self._records = RecordsFolder(options.records)
        with contextlib.ExitStack() as unless_ready:
            unless_ready.callback(self._records.close)
            interrupted = self._load_interrupted_trial() if options.resumes else None
            simulation, reading = interrupted or (self._make_simulation(options.scenario), None)
            self._has_resumed = reading is not None
            self._control_loop = ControlLoop(
                simulation,
                options.records,
                speed=options.speed,
                interrupted=reading,
                trial_limits=self._limits.trials,
                is_seeded=options.is_seeded,
            )
            unless_ready.pop_all()
        self._presenter: RunningPresenter | None = None
        peers_host = options.host if options.connect_to is None else options.connect_to[0]
        self._scenarios = ScenarioLoader(
            self._control_loop, self._make_simulation, is_loopback(peers_host)
        )

    async def run(self, on_ready: Callable[[str], None]) -> None:
        """Serve until SIGTERM or Ctrl-C; `on_ready` is called with address and pairing codes."""
        for problem in self._control_loop.archive.problems:
            _log.warning("%s", problem)
        if self._control_loop.is_first_in_line:
            raise_thread_priority()
        loop = asyncio.get_running_loop()
        link = SimulatorLink(
            latest=lambda: self._control_loop.latest,
            submit=self._submit,
            unacknowledged=self._control_loop.archive.unacknowledged,
            arrivals=lambda: self._control_loop.archive.arrivals,
            find_scenario=self._scenarios.find,
            health=self._health,
            limits=self._limits.clients,
            answers=lambda: tuple(self._assigned.answers.values()),
            slicer_left=self._assigned.curricula.clear,
        )
        feed = StateFeed(link.publisher.is_due, link.publish, loop)
        unsubscribe = self._control_loop.subscribe(feed)
        self._control_loop.subscribe(trial_log(loop))
        tasks = [loop.create_task(link.beat())]
        stop = asyncio.Event()
        views = self._make_views(link, stop, on_ready) if self._options.has_views else None
        presenter, window = self._presenter, None
        # Garbage collection between two ticks stays short if it skips everything loaded so far, in
        # which hardly anything is garbage.
        gc.freeze()
        gc.set_threshold(700)
        with stop_on_signals(stop):
            self._control_loop.thread.start()
            _log.info("The simulator has started.", extra={"data": versions()})
            try:
                port = await self._open(link, tasks, on_ready)
                self._records.announce(self._options.host, port, "")
                if views is not None and presenter is not None:
                    certificates = self._config / "certificates"
                    has_network = self._options.has_network
                    await views.start(
                        self._options.view_port, certificates if has_network else None
                    )
                    page = f"http://{DEFAULT_HOST}:{views.port}"
                    self._records.announce(self._options.host, port, page)
                    tasks.append(loop.create_task(presenter.run()))
                if self._has_resumed:
                    on_ready(self._interruption())
                on_ready(f"computes the robot's kinematics by {kinematics_name()}")
                if self._options.has_desktop and views is not None:
                    window = ApplicationWindow(page, views.code.code)
                    tasks.append(loop.create_task(window.run(stop.set, on_ready)))
                await self._until(stop)
            finally:
                for task in tasks:
                    task.cancel()
                unsubscribe()
                if window is not None:
                    await window.close()
                if views is not None:
                    await views.close()
                if presenter is not None:
                    presenter.close()
                # Pending commands are still answered, and then the connections are closed.
                await asyncio.to_thread(self._scenarios.close)
                await asyncio.to_thread(self._control_loop.stop)
                await link.server.close()
                self._records.close()
                _log.info("The simulator has ended.", extra={"data": self._health()})

    def _load_interrupted_trial(self) -> tuple[Simulation, JournalReading] | None:
        try:
            found = find_interrupted(self._options.records)
            if found is None:
                return None
            reading, interrupted = found
            setup = setup_of(reading.header, self._options.scenario, self._options.robot_meshes)
        except InputError as error:
            _log.warning("An interrupted trial cannot be resumed: %s", error)
            return None
        simulation = Simulation(setup, next(self._seeds))
        simulation.resume_trial(interrupted)
        return simulation, reading

    def _interruption(self) -> str:
        training, scenario = self._control_loop.latest.training, self._control_loop.setup.scenario
        points = task_by_method(scenario, training.task, training.method).labels
        kept = f"{len(training.touches)} of {len(points)} points are kept"
        return (
            f"resumes the interrupted trial of {training.trainee} at {training.task}: {kept}; "
            "resume or abort it"
        )

    def _make_views(
        self, link: SimulatorLink, stop: asyncio.Event, announce: Callable[[str], None]
    ) -> ViewServer:
        # Before the control loop ticks: the import of aiohttp would make ticks late. It also reads
        # all certificate authorities, for clients: a server needs none.
        with temporary_environment({"SSL_CERT_FILE": os.devnull, "SSL_CERT_DIR": os.devnull}):
            from rastrainer_simulator.flow.running_presenter import RunningPresenter
            from rastrainer_simulator.flow.session.services import FlowServices
            from rastrainer_simulator.net.views.view_server import ViewServer

        services = FlowServices(
            config=self._config,
            records=self._options.records,
            use_settings=self._use_settings,
            list_scenarios=self._scenarios.listed,
            use_scenario=self._scenarios.load,
            is_slicer_connected=lambda: link.is_slicer_connected,
            quit=stop.set,
            assigned=self._assigned,
            scores_alone=self._options.scores_alone,
            pin=self._pin,
            draw_seed=lambda: int(default_rng(next(self._seeds)).integers(2**63)),
        )
        running = RunningPresenter(self._control_loop, services, self._options.has_gamepad)
        guidance, loop = running.presenter.trace_guidance, self._control_loop
        link.publisher.is_guided = lambda: guidance(loop.latest).covered_mm > 0.0
        self._presenter = running
        return ViewServer(
            running.presenter.shown,
            running.presenter,
            announce,
            self._options.robot_meshes,
            self._limits.views,
            lambda name: self._scenarios.pictures.get(name),
            self._config,
            self._pin,
        )

    def _use_settings(self, settings: SimulationSettings) -> Future[Answer]:
        self._settings = settings
        return self._scenarios.reload()

    def _make_simulation(self, scenario: Path | None) -> Simulation:
        setup = load_setup(scenario, self._settings, robot_meshes=self._options.robot_meshes)
        return Simulation(setup, next(self._seeds))

    async def _open(
        self, link: SimulatorLink, tasks: list[asyncio.Task[None]], on_ready: Callable[[str], None]
    ) -> int:
        if self._options.connect_to is None:
            port = await link.server.listen(self._options.host, self._options.port)
            on_ready(f"ready on {self._options.host}:{port}")
            return port
        host, port = self._options.connect_to
        tasks.append(asyncio.create_task(link.server.keep_connected_to(host, port)))
        on_ready(f"ready; it connects to {host}:{port}")
        return 0

    async def _until(self, stop: asyncio.Event) -> None:
        while not stop.is_set():
            with contextlib.suppress(asyncio.TimeoutError):
                await asyncio.wait_for(stop.wait(), _LOOP_CHECK_PERIOD_S)
            if not self._control_loop.thread.is_alive():
                raise RASTrainerError("The control loop has failed: the log says why.")

    def _submit(self, name: str, arguments: Mapping[str, Any], sender: str) -> Future[Answer]:
        if name == CommandName.LOAD_SCENARIO:
            return self._scenarios.load(arguments["folder"])
        if name == CommandName.STUDY_STEP:
            self._assigned.take_step(StudyStep(**arguments))
            return answered(Answer(0, True))
        if name == CommandName.CURRICULUM:
            self._assigned.take_curriculum(CurriculumMessage(**arguments))
            return answered(Answer(0, True))
        if name == CommandName.START_TUTORIAL:
            if self._presenter is None:
                return answered(Answer(0, True, data={"isNeeded": False}))
            return answered(self._presenter.presenter.start_tutorial(**arguments))
        if name == CommandName.START_DRILL:
            if self._presenter is None:
                return answered(Answer(0, False, "A drill needs views, which are off here."))
            return answered(self._presenter.presenter.start_drill(**arguments))
        return self._control_loop.submit(name, arguments, sender)

    def _health(self) -> dict[str, Any]:
        statistics = self._control_loop.statistics
        return {
            "ticks": statistics.ticks,
            "lateTicks": statistics.late,
            "skippedTicks": statistics.skipped,
            "worstDelayMs": round(1000.0 * statistics.worst_delay_s, 3),
        }
