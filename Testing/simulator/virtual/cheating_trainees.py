"""Whole trials through the real simulation, played honestly and by trainees who cheat.

Each function plays one task from its start to `Register`, by the protocol's commands alone, and
returns the trial's record with its motion metrics, and the truth.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rastrainer.commands import CommandName, check_arguments
from rastrainer.head.mesh import outward_normals, read_head_mesh
from rastrainer.journal.recording import Recording
from rastrainer.motion.trajectory import Trajectory
from rastrainer.protocol import Proximity, TouchRule
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.score_reference import fiducial_normals
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.record.trial_entries import TrialEntries
from rastrainer_simulator.record.trial_records import with_record
from rastrainer_simulator.state import (
    NEUTRAL_STICKS,
    Answer,
    Motion,
    OperatorCommand,
    OperatorInput,
)
from rastrainer_simulator.training.head_pose import Truth
from rastrainer_simulator.virtual.hand import Skill
from rastrainer_simulator.virtual.play import play_virtual_trial
from Testing.sphere_directions import sphere_directions

DT = 0.02
FLE_MM = 1.0
"""The honest trainee's RMS length of the error of one fiducial, along the skin."""
HONEST = Skill(aim_sd_mm=FLE_MM / np.sqrt(2.0), slip_at=None)
BIAS_MM = 2.0
BRISK_MM_S, SLOW_MM_S = 300.0, 60.0
LIFT_MM = 35.0
DRAG_MM_S, DRAG_PUSH_MM_S = 60.0, 20.0
MAX_DRAG_S = 20.0
FOREVER = 5000
"""Ticks after which a motion that has not ended is a fault of the test."""


@dataclass(frozen=True)
class PlayedTrial:
    """A played trial.

    Attributes:
        record: as the simulator delivers it.
        trajectory: from which its motion was measured.
        truth: where the head was.
        entries: of the journal.
    """

    record: TrialRecord
    trajectory: Trajectory
    truth: Truth
    entries: tuple[dict[str, Any], ...]


def play_honestly(
    setup: SimulationSetup, task: str, seed: int, skill: Skill = HONEST
) -> PlayedTrial:
    """Play as the scripted trainee does."""
    simulation, notes = Simulation(setup, seed), _Notes()
    play_virtual_trial(simulation, task, seed, skill, DT, notes.take)
    return notes.played(simulation)


def aim_off_target(
    setup: SimulationSetup, task: str, seed: int, bias_mm: tuple[float, float, float] | None = None
) -> PlayedTrial:
    """Play honestly, but miss every fiducial by the same vector of World, mm.

    The default is 2 mm in the direction that lies along the skin at as many fiducials as can be:
    parts across the skin move no touch.
    """
    bias = along_skin(setup, task, seed, BIAS_MM) if bias_mm is None else bias_mm
    return play_honestly(setup, task, seed, replace(HONEST, aim_bias_mm=bias))


def along_skin(
    setup: SimulationSetup, task: str, seed: int, length_mm: float
) -> tuple[float, float, float]:
    """Return the vector of World with the greatest part along the skin of a task's fiducials."""
    turn = setup.scenario.perturbed_head_to_world(seed)[:3, :3]
    normals = fiducial_normals(setup.scenario, task) @ turn.T
    direction = np.linalg.eigh(normals.T @ normals)[1][:, 0]
    # The sign of an eigenvector is arbitrary.
    direction *= np.sign(direction[np.abs(direction).argmax()])
    return tuple((length_mm * direction).tolist())


def hover(setup: SimulationSetup, task: str, seed: int, by_mm: float = 9.0) -> PlayedTrial:
    """Touch in the air, off every fiducial by the same vector; every height has to count.

    The vector leads off the skin at as many fiducials as can be.
    """
    pilot = Pilot(within_radius(setup), task, seed)
    offset = by_mm * _most_outward(pilot.normals)
    for place, normal in zip(pilot.fiducials, pilot.normals, strict=True):
        pilot.carry_to(place + offset, normal)
        pilot.touch()
    return pilot.register()


def press(setup: SimulationSetup, task: str, seed: int, depth_mm: float = 2.0) -> PlayedTrial:
    """Touch every fiducial on the skin and command the tip farther in before each touch."""
    pilot = Pilot(setup, task, seed)
    for place, normal in zip(pilot.fiducials, pilot.normals, strict=True):
        pilot.carry_to(place, normal)
        pilot.move(pilot.tip - depth_mm * normal, SLOW_MM_S)
        pilot.touch()
    return pilot.register()


def drag(setup: SimulationSetup, task: str, seed: int) -> PlayedTrial:
    """Slide over the skin from fiducial to fiducial; lift the tip only if it is stuck."""
    pilot = Pilot(setup, task, seed)
    pilot.carry_to(pilot.fiducials[0], pilot.normals[0])
    pilot.touch()
    for place, normal in zip(pilot.fiducials[1:], pilot.normals[1:], strict=True):
        if not pilot.slide_to(place):
            pilot.carry_to(place, normal)
        pilot.move(place, SLOW_MM_S)
        pilot.touch()
    return pilot.register()


CHEATS: dict[str, Callable[[SimulationSetup, str, int], PlayedTrial]] = {
    "hover": hover,
    "aim-beside": aim_off_target,
    "drag": drag,
    "press": press,
}


def within_radius(setup: SimulationSetup) -> SimulationSetup:
    """Return the setup under the paper's rule: a touch counts anywhere near the fiducial."""
    training = replace(setup.settings.training, touch_rule=TouchRule.WITHIN_RADIUS)
    return replace(setup, settings=replace(setup.settings, training=training))


class _Notes:
    """Forms a trial's journal in memory."""

    def __init__(self) -> None:
        self._entries: TrialEntries | None = None
        self._unmeasured = None

    def take(self, simulation, before, operator_input, result) -> None:
        if self._entries is None:
            self._entries = TrialEntries.started(simulation, before, result, DT)
        self._unmeasured = self._entries.add(simulation, operator_input, result)

    def played(self, simulation: Simulation) -> PlayedTrial:
        record = self._unmeasured.measured()
        lines = with_record(self._entries.taken(), record)
        entries = tuple(line.to_json() for line in lines)
        return PlayedTrial(record, Recording.of(lines).trajectory(), simulation.truth, entries)


class Pilot:
    """Steers one trial by commands: positions and displacements are (3,) float, World, mm."""

    def __init__(self, setup: SimulationSetup, task: str, seed: int) -> None:
        self._simulation, self._notes = Simulation(setup, seed), _Notes()
        self._do(CommandName.START_TASK, task=task, trainee="cheat", seed=seed)
        truth = self._simulation.truth
        self.fiducials = truth.in_world(np.array(list(truth.fiducials_ras.values())))
        self.normals = fiducial_normals(setup.scenario, task) @ truth.head_to_world[:3, :3].T
        self._center = truth.in_world(truth.target_ras)
        self._mesh = read_head_mesh(setup.scenario.head)

    @property
    def tip(self) -> np.ndarray:
        return MM_PER_M * self._simulation.state.tool_tip_to_world[:3, 3]

    def touch(self) -> None:
        answer = self._do(CommandName.CAPTURE)
        assert answer.ok, answer.message

    def register(self) -> PlayedTrial:
        answer = self._do(CommandName.REGISTER)
        assert answer.ok, answer.message
        return self._notes.played(self._simulation)

    def move(self, place: np.ndarray, speed_mm_s: float) -> None:
        """Go straight to a position, or as far as the skin lets the tip."""
        self._do(CommandName.MOVE_TIP_TO, positionMm=place.tolist(), speedMmS=speed_mm_s)
        self._rest()

    def carry_to(self, place: np.ndarray, normal: np.ndarray) -> None:
        """Lift the tip, carry it around the head and lower it along the skin's normal there."""
        start, above = self.tip - self._center, place + LIFT_MM * normal
        end = above - self._center
        start = start * (1.0 + LIFT_MM / np.linalg.norm(start))
        for share in np.linspace(0.0, 1.0, 9):
            toward = (1.0 - share) * start + share * end
            radius = (1.0 - share) * np.linalg.norm(start) + share * np.linalg.norm(end)
            self.move(self._center + radius * toward / np.linalg.norm(toward), BRISK_MM_S)
        self.move(place, SLOW_MM_S)

    def slide_to(self, place: np.ndarray) -> bool:
        """Drag the tip over the skin; return whether it came within a millimeter."""
        least, stuck = np.inf, 0
        for _ in range(round(MAX_DRAG_S / DT)):
            to_goal = place - self.tip
            away = float(np.linalg.norm(to_goal))
            if away < 1.0:
                return True
            least, stuck = (away, 0) if away < least - 0.05 else (least, stuck + 1)
            if stuck * DT > 1.0:
                return False
            outward = self._outward_at_tip()
            along = to_goal - outward * float(to_goal @ outward)
            velocity = DRAG_MM_S * along / max(float(np.linalg.norm(along)), 1e-9)
            if self._simulation.state.proximity is not Proximity.CONTACT:
                velocity = velocity - DRAG_PUSH_MM_S * outward
            self._do(CommandName.JOG, velocityMmS=velocity.tolist(), durationS=2 * DT)
        return False

    def _outward_at_tip(self) -> np.ndarray:
        truth = self._simulation.truth
        normal = outward_normals(self._mesh, [truth.in_head(self.tip)])[0]
        return truth.head_to_world[:3, :3] @ normal

    def _rest(self) -> None:
        for _ in range(FOREVER):
            if self._simulation.state.motion is Motion.NONE:
                return
            self._step(NEUTRAL_STICKS)
        raise AssertionError("the arm does not come to rest")

    def _do(self, command: CommandName, **arguments) -> Answer:
        checked = check_arguments(command, arguments)
        return self._step(OperatorInput(commands=(OperatorCommand(command, checked, 0, "cheat"),)))

    def _step(self, operator_input: OperatorInput) -> Answer | None:
        before = self._simulation.state
        result = self._simulation.step(DT, operator_input)
        self._notes.take(self._simulation, before, operator_input, result)
        return result.answers[0] if result.answers else None


def _most_outward(normals: np.ndarray) -> np.ndarray:
    """Return the unit vector whose smallest component along the normals, (n, 3), is greatest."""
    directions = sphere_directions(4000)
    return directions[(directions @ normals.T).min(axis=1).argmax()]
