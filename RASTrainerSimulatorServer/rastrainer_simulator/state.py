"""The simulation's input and state at each tick: frozen values in m, rad and s."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import Future
from dataclasses import dataclass, field
from enum import Enum
from typing import Any

import numpy as np

from rastrainer.journal.entries import Entry, StartingPoint
from rastrainer.procedure.record import UsedRegistration
from rastrainer.protocol import PROCEDURE_PHASES, Phase, Proximity, RegistrationMethod
from rastrainer_simulator.trial_state import (
    GuideAlignment,
    GuideAxis,
    PlannedLine,
    ProcedureState,
    Tool,
    TouchState,
    TraceState,
)
from rastrainer_simulator.vectors import Vector, vector


@dataclass(frozen=True)
class OperatorCommand:
    """One command whose arguments `rastrainer.commands.check_arguments` has accepted.

    `arguments` keep the names and units of the wire (mm); `ticket` is returned in the answer;
    `sender` names the client, for the state's `operator`.
    """

    name: str
    arguments: Mapping[str, Any] = field(default_factory=dict)
    ticket: int = 0
    sender: str = ""


@dataclass(frozen=True)
class OperatorInput:
    """The sticks' positions, −1…1 each, and the commands of one tick.

    `translation` is right, forward (into the picture) and up; `rotation` turns the tool's direction
    to the right and up, and counts only while the direction is steered. `fine` is the trigger for
    fine speed; `operator` names who holds the sticks.
    """

    translation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: tuple[float, float] = (0.0, 0.0)
    fine: bool = False
    commands: tuple[OperatorCommand, ...] = ()
    operator: str = ""


NEUTRAL_STICKS = OperatorInput()
"""The sticks are at rest and no command has arrived."""


class TouchStage(str, Enum):
    """The state of the next touch; the last four are errors, which views show in red.

    `ON_SKIN`: the tip is on the skin where a touch counts. `PRESSED`: it is pressed in a little
    there, and a touch counts. `TOO_DEEP`: it is pressed in.
    `ELSEWHERE`: it is on the skin away from the next point. `SHAFT`: the tool touches the head
    behind its tip. `ARM`: the arm is stopped by the head, the table or itself.
    """

    FAR = "far"
    NEAR = "near"
    ON_SKIN = "on skin"
    PRESSED = "pressed"
    TOO_DEEP = "too deep"
    ELSEWHERE = "elsewhere"
    SHAFT = "shaft"
    ARM = "arm"


TOUCH_ERRORS = (TouchStage.TOO_DEEP, TouchStage.ELSEWHERE, TouchStage.SHAFT, TouchStage.ARM)


class Motion(str, Enum):
    """Source of the tip's movement; `FEED` moves the instrument in the guide, while the arm is
    held.

    `JOG` and `MOVE` are clients' commands, `ALIGN` is the robot's own alignment of the guide.
    """

    NONE = "none"
    STICK = "stick"
    JOG = "jog"
    MOVE = "move"
    ALIGN = "align"
    FEED = "feed"


@dataclass(frozen=True)
class Event:
    """What happened in a tick, as the journal records it; sounds and vibration follow from it."""

    sim_time: float
    entry: Entry


@dataclass(frozen=True)
class Answer:
    """The answer to one command; if it is not `ok`, `message` says what would have been right."""

    ticket: int
    ok: bool
    message: str = ""
    data: Mapping[str, Any] = field(default_factory=dict)


def answered(answer: Answer) -> Future[Answer]:
    done: Future[Answer] = Future()
    done.set_result(answer)
    return done


@dataclass(frozen=True)
class PlanInWorld:
    """A point planned on the MRI, mapped to World (m) by the client's registration.

    `entry` is where the trajectory to it starts, None if only a point was planned. `reachable` is
    whether the robot can carry it out.
    """

    name: str
    position: Vector
    entry: Vector | None = None
    reachable: bool = True


@dataclass(frozen=True)
class TrialResult:
    """The result shown to the trainee when the client has registered and scored the trial (mm)."""

    registration: UsedRegistration
    true_tre_mm: float
    score: float
    details: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class TrainingState:
    """The state of the trial; the same object until something changes.

    `revision` rises with every change that must not be lost (phase, touch, undo, score).
    `registration` is what a client has submitted, None before.
    `next_point` is the label of the fiducial or landmark to touch, None when there is none;
    `rejected` and `undone` count the touches that were refused and undone. `procedure` is None in a
    trial of touches alone. `method` is how the trial is registered, `trace` None if nothing is
    traced; the points of a stroke do not raise the revision, its beginning and its end do.
    """

    revision: int = 0
    phase: Phase = Phase.IDLE
    trainee: str = ""
    task: str = ""
    mode: str = ""
    trial_id: str = ""
    next_point: str | None = None
    instruction: str = ""
    touches: tuple[TouchState, ...] = ()
    rejected: int = 0
    undone: int = 0
    registration: UsedRegistration | None = None
    result: TrialResult | None = None
    procedure: ProcedureState | None = None
    method: RegistrationMethod = RegistrationMethod.FIDUCIALS
    trace: TraceState | None = None

    @property
    def is_marked(self) -> bool:
        """Whether the points to touch are marked on the skin."""
        return self.method is RegistrationMethod.FIDUCIALS

    @property
    def is_running(self) -> bool:
        """Whether the clock of the trial or of its procedure runs."""
        return self.phase in (Phase.RUNNING, *PROCEDURE_PHASES)

    @property
    def is_tracing(self) -> bool:
        """Whether the skin is traced now: all landmarks are touched, and nothing is registered."""
        is_open = self.phase in (Phase.RUNNING, Phase.COMPLETE)
        return self.trace is not None and self.next_point is None and is_open

    @property
    def is_touched(self) -> bool:
        """Whether all points are touched or traced, so that the completion time is known."""
        stage = self.phase if self.procedure is None else self.procedure.stage
        is_open = self.phase in (Phase.IDLE, Phase.RUNNING, Phase.PAUSED)
        return bool(self.touches) and (not is_open or stage in PROCEDURE_PHASES)

    @property
    def completed_s(self) -> float:
        traced = () if self.trace is None else self.trace.points
        return traced[-1].elapsed if traced else self.touches[-1].elapsed


@dataclass(frozen=True)
class SimulationState:
    """Everything a view needs after a tick (World, m, rad, s).

    `q` are the seven joint angles; `tool_tip_to_world`, each of `link_to_world` (links 0 to 7),
    `head_to_world` and `stand_to_world` (its origin in the middle of the head's base, upright)
    are (4, 4) float arrays that are never written again. `clearance` is the signed distance of the
    tool to the head, `depth` how far the commanded motion has gone into it beyond where the tool
    could go (`collision.proximity`), 0 without contact. `elapsed` is the running trial's time,
    pauses excluded. `operator` is who last moved the arm. `touch` is how the next touch is going.
    `feed` is how far drill or electrode is beyond the guide's tip.
    `tip_clearance` is the signed distance of the tip to the skin.
    """

    tick: int
    sim_time: float
    q: tuple[float, ...]
    tool_tip_to_world: np.ndarray
    link_to_world: tuple[np.ndarray, ...]
    head_to_world: np.ndarray
    stand_to_world: np.ndarray
    proximity: Proximity
    clearance: float
    training: TrainingState
    elapsed: float
    motion: Motion
    operator: str
    camera: str
    planned_target: PlanInWorld | None
    depth: float = 0.0
    touch: TouchStage = TouchStage.FAR
    feed: float = 0.0
    tip_clearance: float = 0.0

    @property
    def tip(self) -> Vector:
        return vector(self.tool_tip_to_world[:3, 3].tolist())

    @property
    def body_poses(self) -> tuple[np.ndarray, ...]:
        """The poses of links, tool, head and stand, as the scene's bodies are ordered."""
        others = self.tool_tip_to_world, self.head_to_world, self.stand_to_world
        return (*self.link_to_world, *others)

    @property
    def starting_point(self) -> StartingPoint:
        """Where another simulation continues."""
        return StartingPoint(self.tick, self.sim_time, self.training.revision, self.camera)

    @property
    def completion_time(self) -> float:
        """The trial's time in s, which stops at the last point."""
        return self.training.completed_s if self.training.is_touched else self.elapsed

    @property
    def procedure_time(self) -> float | None:
        """How long the trial's procedure has taken since the registration, s; None before."""
        procedure = self.training.procedure
        if procedure is None or procedure.stage is Phase.RUNNING:
            return None
        return self.elapsed - procedure.times_s.get(Phase.RUNNING, 0.0)

    @property
    def tool(self) -> Tool:
        procedure = self.training.procedure
        return Tool.POINTER if procedure is None else procedure.tool

    @property
    def plan_in_world(self) -> PlannedLine | None:
        """The current planned line, as the registration in use shows it; None without one."""
        procedure = self.training.procedure
        here = None if procedure is None else procedure.present
        return None if here is None else here.line

    @property
    def guide_axis(self) -> GuideAxis:
        pose = self.tool_tip_to_world
        return GuideAxis(vector(pose[:3, 3].tolist()), vector(pose[:3, 2].tolist()))

    @property
    def alignment(self) -> GuideAlignment | None:
        """The position of the guide relative to the current planned line; None without one."""
        line = self.plan_in_world
        return None if line is None else GuideAlignment.of(self.guide_axis, line)


@dataclass(frozen=True)
class StepResult:
    """The result of one step: the state, the events and the answers to the tick's commands."""

    state: SimulationState
    events: tuple[Event, ...] = ()
    answers: tuple[Answer, ...] = ()
