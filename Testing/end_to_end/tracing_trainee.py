"""A trainee who registers by surface over OpenIGTLink: landmarks first, then strokes."""

from __future__ import annotations

import json

import numpy as np

from rastrainer import transforms
from rastrainer.head.mesh import outward_normals, read_head_mesh
from rastrainer.protocol import Proximity
from rastrainer.scenario.scenario import Scenario, method_of, task_by_method
from Testing.end_to_end.test_trial_over_openigtlink import Player
from Testing.simulator.landmarked import on_skin

ABOVE_MM, LANDED_MM, PASSED_MM = 30.0, 0.6, 1.5
SINK_MM, GLIDE_MM = 0.3, 0.15
"""How far below the skin the tip is sent to land, and above it to glide: neither is pressing."""
LEANS = ((0.0, 0.0, -0.4), (0.0, 0.0, -0.8), (0.0, 0.0, 0.0), (0.0, 0.4, -0.4), (0.0, -0.4, -0.4))
"""Additions to the direction into the skin, tried one after the other."""
SPEED_MM_S = 60
TIMEOUT_S = 60


class TracingTrainee:
    """Plays a trial of a seed, by which it knows where the head is, as a person sees it.

    Attributes:
        player: its connection.
    """

    def __init__(self, player: Player, scenario: Scenario, seed: int) -> None:
        self.player = player
        self._scenario, self._seed = scenario, seed
        self._head = read_head_mesh(scenario.head)
        self._to_world = scenario.perturbed_head_to_world(seed)
        self._lean = np.array(LEANS[0])

    def start(self, method: str) -> str:
        """Start a trial and touch its landmarks; return its ID."""
        started = self.player.do(
            "StartTask", task="task-1", trainee="anna", seed=self._seed, method=method
        )
        task = task_by_method(self._scenario, "task-1", method_of(method))
        for landmark in task.fiducials:
            self._land(landmark)
            self.player.do("Capture")
            self._lift(landmark)
        return started["trialId"]

    def trace(self, corners, ends: bool = True) -> None:
        """Draw a stroke over the skin; without its end, the tip stays where it arrives."""
        places = on_skin(self._head, corners)
        self._land(places[0])
        self.player.do("Trace", on=True)
        for place in places[1:]:
            self._go(place, GLIDE_MM, SPEED_MM_S)
        if ends:
            self.player.do("Trace", on=False)
            self.lift_after(corners)

    def lift_after(self, corners) -> None:
        """Lift the tip where a stroke ends."""
        self._lift(on_skin(self._head, corners[-1:])[0])

    def state(self, is_wanted=bool) -> dict:
        """Wait for a state of the simulator and return it."""
        found = self.player.wait_for(
            "SimState", lambda m: is_wanted(json.loads(m.content.text)), TIMEOUT_S
        )
        return json.loads(found.content.text)

    def _land(self, place) -> None:
        """Lower the tip onto a place; if the tool meets the skin next to it, lean it again."""
        for lean in LEANS:
            self._lean = np.array(lean)
            self._go(place, ABOVE_MM, 400)
            goal = self._send(place, -SINK_MM, 300)
            self.state(lambda state, goal=goal: self._off(goal) < LANDED_MM or _is_held(state))
            if self._off(goal) < LANDED_MM:
                return
            self._lift(place)
        raise AssertionError(f"the tip never landed at {place}")

    def _lift(self, place) -> None:
        self._go(place, ABOVE_MM, 400)

    def _go(self, place, above_mm: float, speed_mm_s: float) -> None:
        """Move the tip above a place of the head, RAS, until it is nearly there."""
        goal = self._send(place, above_mm, speed_mm_s)
        self.player.wait_for("ToolTipToWorld", lambda _tip: self._off(goal) < PASSED_MM, TIMEOUT_S)

    def _send(self, place, above_mm: float, speed_mm_s: float) -> np.ndarray:
        """Send the tip above a place of the head, or below it; return where to, World, mm."""
        normal = outward_normals(self._head, [place])[0]
        goal = transforms.apply(self._to_world, place + above_mm * normal)
        direction = self._lean - self._to_world[:3, :3] @ normal
        self.player.do(
            "MoveTipTo",
            positionMm=goal.tolist(),
            direction=(direction / np.linalg.norm(direction)).tolist(),
            speedMmS=speed_mm_s,
        )
        return goal

    def _off(self, goal: np.ndarray) -> float:
        """Return how far the tip is from a place in World, mm."""
        tip = np.array(self.player.latest["ToolTipToWorld"].content.matrix)[:3, 3]
        return float(np.linalg.norm(tip - goal))


def _is_held(state: dict) -> bool:
    """Whether the skin holds the tool off where it is sent to."""
    return state["proximity"] == Proximity.CONTACT.value
