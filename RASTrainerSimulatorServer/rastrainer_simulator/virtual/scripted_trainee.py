"""A virtual trainee: seeded hands that drive the robot by the protocol's commands alone.

It sees what a person sees (the tool tip, the numbered fiducials) and answers with `Jog`, `Capture`,
`Undo` and `Register`, at human speed, with drift, tremor, overshoot and one touch taken back. The
demo lets it play over OpenIGTLink; tests and cohort simulations step it together with a simulation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer import transforms
from rastrainer.commands import CommandName
from rastrainer.errors import RASTrainerError
from rastrainer.head.mesh import HeadMesh
from rastrainer.protocol import SPEED_LIMIT_MM_S, Phase
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.score_reference import computed_once, fiducial_normals
from rastrainer_simulator.teleoperation.teleoperation import TeleoperationSettings
from rastrainer_simulator.virtual.hand import DECISION_PERIOD_S, Hand, Skill

LIFT_MM = 35.0
"""How far the tip is lifted off the skin before it travels to the next fiducial."""

LAST_MM = 10.0
"""Distance from a fiducial within which the tip goes at the fine speed, as the feedback advises."""

PRESS_MM = 0.8
"""How far below the skin the last aim is: the touch of the tip should be felt."""

LOWEST_DIP = np.radians(5.0)
"""The path around the head's center may be lower than both of its ends by this angle."""

JOG_DURATION_S = 0.1
FINE_SHARE = TeleoperationSettings().fine_speed / TeleoperationSettings().coarse_speed
STUCK_AFTER_S = 12.0
"""Time limit of aiming at a fiducial: after that, the trainee touches where the tip is."""

LONGEST_TRIAL_S = 1800.0

Action = tuple[str, dict[str, Any]]


class TrialStoppedError(RASTrainerError):
    """The trial could not be played to its end."""


@dataclass(frozen=True)
class Observation:
    """The view of the trainee.

    The tool is shown to touch the head or not; `next_point` is the number of the fiducial to touch,
    from 1, 0 if there is none.
    """

    sim_time_s: float
    tip_mm: np.ndarray
    is_in_contact: bool
    phase: Phase
    next_point: int


class ScriptedTrainee:
    """Plays one trial; `decide` is called with each observation and answers with what to send."""

    def __init__(
        self,
        scenario: Scenario,
        task_name: str,
        head_to_world: np.ndarray,
        skill: Skill,
        seed: int,
        command_period_s: float = DECISION_PERIOD_S,
    ) -> None:
        """Play a task; HeadToWorld is (4, 4) float, mm.

        The hand trembles between its decisions, too, if commands may be sent more often.
        """
        # As seen in the room, World, mm: (n, 3), (n, 3), the center of the head and its top.
        self._fiducials = transforms.apply(head_to_world, scenario.task(task_name).fiducials)
        self._normals = fiducial_normals(scenario, task_name) @ head_to_world[:3, :3].T
        self._center = transforms.apply(head_to_world, scenario.target.position_ras)
        self._vertex = transforms.apply(head_to_world, computed_once(scenario, _vertex))
        self._skill = skill
        self._random = np.random.default_rng(seed)
        self._hand = Hand(skill, self._random, seed)
        self._command_period_s = min(command_period_s, DECISION_PERIOD_S)
        self._slip_at = skill.slip_at and int(np.random.default_rng([seed, 1]).integers(2, 15))
        self._planned_for: int | None = None
        self._touched: int | None = None
        self._is_refused = False
        self._is_undoing_touch = False
        self._path: list[np.ndarray] = []
        self._acts_from_s = 0.0
        self._gives_up_at_s = np.inf
        self._jogs_from_s = np.inf
        self._eases_off = False
        self._outward_at_aim = np.zeros(3)

    def decide(self, observation: Observation) -> Action | None:
        """Return the command to send now, or None to wait."""
        if observation.sim_time_s < self._acts_from_s:
            return self._jog(observation) if observation.sim_time_s > self._jogs_from_s else None
        self._acts_from_s = observation.sim_time_s + DECISION_PERIOD_S
        self._jogs_from_s = np.inf
        if observation.phase not in (Phase.RUNNING, Phase.COMPLETE):
            return None
        if self._is_undoing_touch:
            # As soon as the slip is seen to have been recorded.
            if observation.next_point == self._touched:
                return None
            self._is_undoing_touch = False
            self._touched = None
            self._acts_from_s = observation.sim_time_s + self._skill.reaction_s
            return CommandName.UNDO, {}
        if observation.phase is Phase.COMPLETE:
            return CommandName.REGISTER, {}
        if observation.next_point == self._touched:
            return None
        if observation.next_point and observation.next_point != self._planned_for:
            self._plan(observation, observation.next_point)
            return None
        return self._approach(observation)

    def touch_refused(self) -> None:
        """Note that the last touch was refused: the trainee approaches the point from above."""
        self._touched = None
        self._is_refused = True
        self._is_undoing_touch = False

    def _plan(self, observation: Observation, point: int) -> None:
        """Lift off, travel around the head, come down along the skin's outward direction.

        A refused touch means that not the tip but another part of the tool is at the head. The arm
        comes to the same point from above in another posture.
        """
        self._hand.release()
        fiducial = self._fiducials[point - 1]
        outward = self._normals[point - 1]
        error = self._random.normal(self._skill.aim_bias_mm, self._skill.aim_sd_mm, 3)
        if point == self._slip_at:
            error = error + 4.0 * self._random.choice([-1.0, 1.0], 3) / np.sqrt(3.0)
        aim = fiducial + error - outward * float(error @ outward)
        lifted = observation.tip_mm + LIFT_MM * self._outward(observation.tip_mm)
        above = fiducial + LIFT_MM * outward
        past = above + self._skill.overshoot * (above - lifted)
        near = fiducial + LAST_MM * outward
        self._path = [*self._way(lifted, past, self._is_refused), above, near, aim]
        self._is_refused = False
        self._outward_at_aim = outward
        self._planned_for = point
        self._acts_from_s = observation.sim_time_s + self._skill.reaction_s
        self._gives_up_at_s = np.inf

    def _approach(self, observation: Observation) -> Action | None:
        if not self._path:
            self._touched = self._planned_for
            self._is_undoing_touch = self._touched == self._slip_at
            if self._is_undoing_touch:
                self._slip_at = None
            self._planned_for = None
            return CommandName.CAPTURE, {}
        is_aim = len(self._path) == 1
        remaining = self._path[0] - observation.tip_mm
        fastest = self._skill.speed_mm_s * (FINE_SHARE if is_aim else 1.0)
        if is_aim and np.isinf(self._gives_up_at_s):
            # However long the path was.
            self._gives_up_at_s = observation.sim_time_s + STUCK_AFTER_S
        gave_up = is_aim and observation.sim_time_s > self._gives_up_at_s
        if is_aim:
            # At any height over the aim.
            beside_mm = np.linalg.norm(self._along_skin(remaining))
            is_there = observation.is_in_contact and beside_mm < self._skill.settled_mm
            remaining = remaining - PRESS_MM * self._outward_at_aim
        else:
            is_there = np.linalg.norm(remaining) < 8.0
        if is_there or gave_up:
            self._path.pop(0)
            if not is_aim:
                return self._approach(observation)
            self._acts_from_s = observation.sim_time_s + self._skill.dwell_s
            return None
        self._hand.correct(remaining, fastest)
        # In contact the hand stops pushing: it only corrects along the skin.
        self._eases_off = is_aim and observation.is_in_contact
        return self._jog(observation)

    def _jog(self, observation: Observation) -> Action:
        start_s, end_s = observation.sim_time_s, observation.sim_time_s + self._command_period_s
        self._jogs_from_s = end_s - 1e-6
        velocity = self._hand.velocity(start_s, end_s)
        sent = self._along_skin(velocity) if self._eases_off else velocity
        limited = np.clip(sent, -SPEED_LIMIT_MM_S, SPEED_LIMIT_MM_S)
        rounded = [round(float(component), 3) for component in limited]
        return CommandName.JOG, {"velocityMmS": rounded, "durationS": JOG_DURATION_S}

    def _along_skin(self, displacement: np.ndarray) -> np.ndarray:
        return displacement - self._outward_at_aim * float(displacement @ self._outward_at_aim)

    def _outward(self, position: np.ndarray) -> np.ndarray:
        away = position - self._center
        return away / max(float(np.linalg.norm(away)), 1e-9)

    def _way(self, start: np.ndarray, end: np.ndarray, from_above: bool) -> list[np.ndarray]:
        """Waypoints around the head; over its vertex if asked for, or instead of under the head."""
        direct, up = self._arc(start, end), self._outward(self._vertex)
        heights = [float(np.arcsin(np.clip(self._outward(one) @ up, -1.0, 1.0))) for one in direct]
        if not from_above and min(heights) > min(heights[0], heights[-1]) - LOWEST_DIP:
            return direct
        top = self._vertex + LIFT_MM * up
        return [*self._arc(start, top), *self._arc(top, end)[1:]]

    def _arc(self, start: np.ndarray, end: np.ndarray) -> list[np.ndarray]:
        """Waypoints from start to end around the head's center, every 15 degrees."""
        first, last = self._outward(start), self._outward(end)
        angle = float(np.arccos(np.clip(first @ last, -1.0, 1.0)))
        count = max(1, int(np.ceil(np.degrees(angle) / 15.0)))
        radii = np.linspace(
            np.linalg.norm(start - self._center), np.linalg.norm(end - self._center), count + 1
        )
        if angle < 1e-3 or angle > np.pi - 1e-3:
            return [start, end]
        weights = np.linspace(0.0, 1.0, count + 1)[:, None]
        directions = np.sin((1 - weights) * angle) * first + np.sin(weights * angle) * last
        return list(self._center + radii[:, None] * directions / np.sin(angle))


def _vertex(head: HeadMesh) -> np.ndarray:
    """Return the vertex of the head, (3,) float, RAS mm."""
    return head.vertices[head.vertices[:, 2].argmax()].copy()
