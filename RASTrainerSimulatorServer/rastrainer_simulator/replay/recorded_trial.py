"""A recorded trial as the states that a view shows, without simulation."""

from __future__ import annotations

import bisect
import threading
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace
from pathlib import Path
from typing import Generic, TypeVar

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import read_head_mesh
from rastrainer.journal.entries import CameraChange, Line, ProximityChange, Registered
from rastrainer.journal.recording import ReplayTrack, read_track
from rastrainer.json_records import record_from_json
from rastrainer.protocol import Phase, Proximity
from rastrainer.scenario.scenario import Scenario, task_by_method
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.analysis import analyze_trial
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.collision.collision import stand_pose
from rastrainer_simulator.core.interrupted_trial import (
    RecordedFeed,
    recorded_steps,
    refusing_malformed,
    seed_of,
)
from rastrainer_simulator.core.settings import SimulationSettings
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.loop.timing import raise_thread_priority
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.state import Event, Motion, SimulationState, TrainingState
from rastrainer_simulator.training.rules import TouchMoment, touch_stage
from rastrainer_simulator.training.training import Training
from rastrainer_simulator.trial_state import Tool

AFTER_S = 0.25
"""How long after the worst touch its replay ends."""


Situation = tuple[TrainingState, Proximity, str]
"""The visible state besides the arm: trial, proximity and camera, from one event to the next."""


class RecordedTrial:
    """A trial from its start to its end, in the trial's time: a pause takes none.

    Joint angles and clearance are interpolated linearly between the journal's 50 samples a second;
    touches, phases, contact, camera and planned target are as recorded.

    `worst` is the label of the touch with the largest error, and from when to when it was
    approached, in s; None for a trial that was not registered.
    """

    def __init__(self, track: ReplayTrack, setup: SimulationSetup) -> None:
        """Prepare a trial; `setup` has the scenario and the robot that it was recorded with."""
        with refusing_malformed("The trial cannot be shown again: an entry is not as it should be"):
            header, scenario = track.header, setup.scenario
            other = setup.difference(header)
            if other:
                words = {"procedure": "another procedure", "landmarks": "other landmarks"}
                raise InputError(
                    f"The trial was recorded with {words.get(other, 'another scenario or robot')}."
                )
            if not track.events:
                raise InputError("The trial cannot be shown again: its journal holds no event.")
            self.trainee, self.task = header.trainee, header.task
            self._track = track
            self._kinematics = make_kinematics(setup.robot)
            self._links = tuple(link.name for link in setup.robot.moving_links)
            self._tip = setup.robot.tip.name
            head_to_world = scenario.perturbed_head_to_world(seed_of(header))
            self._head_to_world = transforms.in_meters(head_to_world)
            base = read_head_mesh(scenario.head).base / MM_PER_M
            self._stand_to_world = stand_pose(self._head_to_world, base)
            self._event_times = [event.time_s for event in track.events]
            self.duration_s = max(float(track.trajectory.times_s[-1]), self._event_times[-1])
            settings = record_from_json(SimulationSettings, header.settings, "The settings")
            task = task_by_method(scenario, self.task, header.registration_method)
            self._situations = _situations(track, scenario, settings)
            places = transforms.apply(self._head_to_world, task.fiducials / MM_PER_M)
            self._goals = dict(zip(task.labels, map(tuple, places.tolist()), strict=True))
            self._training_settings = settings.training
            self.worst = _worst(track, setup)

    def state_at(self, time_s: float) -> SimulationState:
        track, trajectory = self._track, self._track.trajectory
        q = tuple(track.at(time_s, track.q).tolist())
        poses = self._kinematics.links(q)
        depth = trajectory.depth_mm
        # What happened in the first tick is visible from the beginning.
        place = max(0, bisect.bisect_right(self._event_times, time_s) - 1)
        training, proximity, camera = self._situations[place]
        clearance = float(track.at(time_s, trajectory.clearance_mm)) / MM_PER_M
        depth_m = 0.0 if depth is None else float(track.at(time_s, depth)) / MM_PER_M
        tip = tuple(poses[self._tip][:3, 3].tolist())
        procedure = training.procedure
        is_fed = procedure is not None and procedure.tool in (Tool.DRILL, Tool.ELECTRODE)
        elapsed = time_s
        if training.phase is Phase.IDLE:
            elapsed = 0.0
        elif procedure is None and training.phase not in (Phase.RUNNING, Phase.PAUSED):
            elapsed = training.completed_s
        return SimulationState(
            tick=track.header.before.tick + round(time_s / track.header.tick_s),
            sim_time=track.start_s + time_s,
            q=q,
            tool_tip_to_world=poses[self._tip],
            link_to_world=tuple(poses[name] for name in self._links),
            head_to_world=self._head_to_world,
            stand_to_world=self._stand_to_world,
            proximity=proximity,
            clearance=clearance,
            training=training,
            elapsed=elapsed,
            motion=Motion.NONE,
            operator="",
            camera=camera,
            planned_target=None,
            depth=depth_m,
            feed=float(track.at(time_s, track.feed_mm)) / MM_PER_M if is_fed else 0.0,
            # The journal has one clearance for the whole tool: a contact counts as the tip's.
            touch=touch_stage(
                TouchMoment(time_s, tip, clearance, depth_m),
                proximity,
                "",
                training,
                self._goals.get(training.next_point or ""),
                self._training_settings,
            ),
        )

    def events_between(self, after_s: float, until_s: float) -> tuple[Event, ...]:
        """Return what happened later than one time and no later than another."""
        first = bisect.bisect_right(self._event_times, after_s)
        end = bisect.bisect_right(self._event_times, until_s)
        found = self._track.events[first:end]
        return tuple(Event(each.at.sim_time_s, each.entry) for each in found)


T = TypeVar("T")


class JournalLoading(Generic[T]):
    """Reads journals in a thread while the control loop runs; `loaded` is the result."""

    def __init__(self, load: Callable[[Callable[[], None]], T]) -> None:
        """Start; `load` is given a function that raises InputError as soon as it is canceled."""
        self.loaded: Future[T] = Future()
        self._is_canceled = False
        threading.Thread(target=self._load, args=(load,), name="loading", daemon=True).start()

    def cancel(self) -> None:
        self._is_canceled = True

    def _load(self, load: Callable[[Callable[[], None]], T]) -> None:
        # Set aside while it holds the interpreter, it would make the control loop wait.
        raise_thread_priority()
        try:
            self.loaded.set_result(load(self._check))
        except Exception as error:
            self.loaded.set_exception(error)

    def _check(self) -> None:
        if self._is_canceled:
            raise InputError("The trial cannot be shown again: loading it was canceled.")


TrialLoading = JournalLoading[RecordedTrial]


def load_trial(journal: Path, setup: SimulationSetup) -> TrialLoading:
    return JournalLoading(lambda check: RecordedTrial(read_track(journal, check), setup))


def _situations(
    track: ReplayTrack, scenario: Scenario, settings: SimulationSettings
) -> list[Situation]:
    """Return the situation after each event; the trial's state machine repeats the commands."""
    header, training = track.header, Training(scenario, 0, settings.training, settings.procedure)
    # A recording that failed names the revision that it returned to.
    training.restart_from(header.before.revision)
    lines = [Line(event.at, event.entry) for event in track.events]
    steps = deque(recorded_steps(lines, header, RecordedFeed()))
    proximity, camera = Proximity.FREE, header.before.camera or settings.camera
    seen, situations = training.state, []
    for line in lines:
        while steps and steps[0][0].tick <= line.at.tick:
            _at, command, moment = steps.popleft()
            training.handle(command, moment)
        match line.entry:
            case ProximityChange():
                proximity = line.entry.to
            case CameraChange():
                camera = line.entry.camera
        now = training.state
        # An aborted trial stays in view.
        seen = now if now.trial_id else replace(seen, phase=Phase.IDLE, next_point=None)
        situations.append((seen, proximity, camera))
    return situations


def _worst(track: ReplayTrack, setup: SimulationSetup) -> tuple[str, float, float] | None:
    registered = next((e.entry for e in track.events if isinstance(e.entry, Registered)), None)
    if registered is None:
        return None
    record = record_from_json(TrialRecord, registered.record)
    worst = analyze_trial(record, setup.scenario, trajectory=track.trajectory).feedback.worst
    ends = {touch.label: touch.time_s for touch in track.trajectory.touches}
    labels = [point.label for point in record.points]
    place = labels.index(worst.label)
    begin = ends[labels[place - 1]] if place else 0.0
    return worst.label, begin, ends[worst.label] + AFTER_S
