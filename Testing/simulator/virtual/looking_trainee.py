"""A model trainee that knows only the pictures: it looks, turns the view and steers."""

from __future__ import annotations

from collections import deque
from typing import Protocol

import numpy as np

from rastrainer.protocol import Phase
from rastrainer_simulator.state import TouchStage
from Testing.simulator.flow.trainee import Trainee
from Testing.simulator.virtual.drawn_pictures import DrawnPictures, Look

LOOK_STEPS, LATE_LOOKS = 10, 3
"""Steps of the simulation between two looks, and how many of these it reacts late: 0.24 to 0.32 s
after what there is to see, as people do."""
GAIN_PER_S = 2.5
HOVER_M = 0.03
"""How far off the skin the tip travels."""
OVER_M = 0.01
"""Nearer than this to the position above the fiducial, the tip is lowered."""
SLOWLY_M_S = 0.019
"""Near the skin, as a tone and the ring tell, the tip is moved in slow motion."""
AIM_M, COARSE_AIM_M = 0.0012, 0.002
"""The aim on the skin, also for hands that push one stick at a time."""
GO_AROUND_M = 0.03
"""Farther from the fiducial than this, what the tip approaches is not its goal."""
LIFT_LOOKS = 15
LOST_LOOKS = 12
"""After so many looks without the tip, the view zooms out again."""
ZOOM_LOOKS = 12
TURN_LOOKS = 8
"""The view turns by 70° in a second."""
NEAR_VIEW_M = 0.08
"""Nearer to the fiducial than this, the best view shows the tip, too."""
PATIENCE_S = 60.0
STEEP = 0.5
"""Where the upward part of the skin's normal is less, the tip comes level, by one stick alone."""


class NotTouchedError(AssertionError):
    """The trainee has given up a point."""


class TrainedHands(Protocol):
    """The trainee's hands."""

    def move(self, velocity: np.ndarray) -> None:
        """Move the tip, (3,) float, m/s: right, forward, up."""

    def stop(self) -> None:
        """Release what moves the tip."""

    def hold(self, control: str, is_down: bool) -> None:
        """Hold a control of the view, or release it."""


class LookingTrainee:
    """Touches the fiducials of the trial that runs, by its pictures.

    Only the main picture shows the tip next to the fiducial, and only the small picture its height.
    While a camera stands still, a fiducial that the tool hides is remembered.

    Args:
        trainee: at the presenter.
        hands: steer the arm.
        pictures: show the scene.
        is_one_by_one: whether its hands push one stick at a time: it then comes down onto a
            fiducial by one of them alone, and does not follow the skin's normal.
    """

    def __init__(
        self,
        trainee: Trainee,
        hands: TrainedHands,
        pictures: DrawnPictures,
        is_one_by_one: bool = False,
    ) -> None:
        self._trainee = trainee
        self._hands = hands
        self._pictures = pictures
        self._looks: deque[Look] = deque(maxlen=1 + LATE_LOOKS)
        self._is_one_by_one = is_one_by_one
        self._aim_m = COARSE_AIM_M if is_one_by_one else AIM_M
        self._label = ""
        self._normal = self._outward = np.array([0.0, 0.0, 1.0])
        self._is_far_away = False
        self._goals: list[np.ndarray | None] = [None, None]

    def play(self, limit_s: float) -> None:
        """Continue until all points are touched, or until the trial has lasted so long."""
        trainee = self._trainee
        task = trainee.loop.setup.scenario.task(trainee.state.training.task)
        self._pictures.use(task, trainee.state.head_to_world)
        while trainee.state.training.phase is Phase.RUNNING and trainee.state.elapsed < limit_s:
            self._label = trainee.state.training.next_point or ""
            self._touch()

    @property
    def _kept(self) -> int:
        return len(self._trainee.state.training.touches)

    def _touch(self) -> None:
        """Find the next fiducial, travel to it and touch it, until the touch counts."""
        kept, give_up = self._kept, self._trainee.state.sim_time + PATIENCE_S
        if kept:
            self._lift()
        self._find()
        while self._kept == kept:
            now = self._trainee.state.sim_time
            if now > give_up:
                raise NotTouchedError(f"{self._label}: not touched in {PATIENCE_S:g} s")
            if self._travel() and self._lower():
                self._press()

    def _look(self) -> Look:
        """Let a moment pass, and look."""
        trainee = self._trainee
        trainee.step(LOOK_STEPS)
        self._looks.append(
            self._pictures.look(
                trainee.state, trainee.presenter.pictures(trainee.state), self._label
            )
        )
        look = self._looks[0]
        if not look.is_still:
            self._goals = [None, None]
        for index, picture in enumerate((look.main, look.beside)):
            is_identified = "number" in picture.spots or self._goals[index] is not None
            if is_identified and "fiducial" in picture.spots:
                self._goals[index] = picture.spots["fiducial"]
        if look.outward is not None:
            self._normal, self._outward = look.outward, self._along_one(look.outward)
        return look

    def _along_one(self, outward: np.ndarray) -> np.ndarray:
        """Return the way off the skin, (3,) float: up or level where one stick has to do."""
        if not self._is_one_by_one:
            return outward
        parts = outward * ([0, 0, 1] if outward[2] > STEEP else [1, 1, 0])
        return parts / np.linalg.norm(parts)

    def _lift(self) -> None:
        """Lift the tip off the skin, until its color says that it is far from the head."""
        for _ in range(LIFT_LOOKS):
            look = self._look()
            if look.stage is TouchStage.FAR:
                break
            self._push(look, 0.08 * self._outward)
        self._hands.stop()

    def _find(self) -> None:
        """Have the best view shown, and turn on until the fiducial is seen with its number."""
        self._is_far_away = False
        self._trainee.tap("best_view")
        self._wait_for_view()
        for _ in range(40):
            if self._goals[0] is not None:
                return
            self._hands.hold("view_right", True)
            self._look()
            self._hands.hold("view_right", False)
            self._wait_for_view()
        raise AssertionError(f"{self._label} is seen from nowhere")

    def _turn_view(self) -> None:
        """Look from the side, where it is seen how far before the fiducial the tip is."""
        self._hands.hold("view_right", True)
        for _ in range(TURN_LOOKS):
            self._look()
        self._hands.hold("view_right", False)
        self._wait_for_view()

    def _wait_for_view(self) -> None:
        while not self._look().is_still:
            pass
        self._look()

    def _travel(self) -> bool:
        """Carry the tip to a position above the fiducial; return whether it is there."""
        unseen = returned = unjudged = 0
        for _ in range(400):
            look = self._look()
            to_fiducial = self._way(look, "fiducial")
            if to_fiducial is None or "tip" not in look.main.spots:
                unseen += 1
                self._search(look, unseen)
                continue
            unseen = 0
            if self._is_far_away and np.linalg.norm(to_fiducial) < NEAR_VIEW_M:
                self._hands.stop()
                # Lost once more, the tip is not near: it only lies before or behind the fiducial.
                (self._turn_view if returned % 2 else self._find)()
                returned += 1
                continue
            beside = to_fiducial - self._outward * (to_fiducial @ self._outward)
            goal = to_fiducial + HOVER_M * self._outward
            if np.linalg.norm(goal) < OVER_M:
                if self._is_judged(look):
                    self._hands.stop()
                    return True
                unjudged += 1
                if unjudged % LOST_LOOKS == 0:
                    self._hands.stop()
                    self._turn_view()
            velocity = GAIN_PER_S * goal
            if look.stage is not TouchStage.FAR and np.linalg.norm(beside) > GO_AROUND_M:
                velocity = self._around_head(look, velocity)
            self._push(look, velocity)
        return False

    def _is_judged(self, look: Look) -> bool:
        """Return whether both pictures show the tip, and show or have shown the fiducial."""
        return all(
            "tip" in picture.spots and ("fiducial" in picture.spots or kept is not None)
            for picture, kept in zip((look.main, look.beside), self._goals, strict=True)
        )

    def _around_head(self, look: Look, velocity: np.ndarray) -> np.ndarray:
        """Return a velocity that leads around the head, which the tip has come near."""
        from_head = self._way(look, "head")
        away = self._outward if from_head is None else -from_head / np.linalg.norm(from_head)
        away = away + self._outward
        away /= np.linalg.norm(away)
        inward = min(0.0, float(velocity @ away))
        return velocity - inward * away + 0.06 * away

    def _search(self, look: Look, unseen: int) -> None:
        """Look for the tip: from farther away, and if it is hidden raise it."""
        if unseen % LOST_LOOKS == 1:
            self._hands.stop()
            self._hands.hold("view_farther", True)
            for _ in range(ZOOM_LOOKS):
                if "tip" in self._look().main.spots:
                    break
            self._hands.hold("view_farther", False)
            self._is_far_away = True
            self._wait_for_view()
        else:
            self._push(look, np.array([0.0, 0.0, 0.08]))

    def _lower(self) -> bool:
        """Lower the tip onto the fiducial; return whether it rests there."""
        for _ in range(250):
            look = self._look()
            to_fiducial = self._way(look, "fiducial")
            if to_fiducial is None or not self._is_judged(look):
                self._push(look, 0.01 * self._outward)
                return False
            height = -float(to_fiducial @ self._outward)
            beside = to_fiducial + height * self._outward
            off = float(np.linalg.norm(beside))
            missed = to_fiducial - (to_fiducial @ self._normal) * self._normal
            if look.stage is TouchStage.ON_SKIN and np.linalg.norm(missed) < self._aim_m:
                self._hands.stop()
                return True
            if look.stage not in (TouchStage.FAR, TouchStage.NEAR, None):
                velocity = GAIN_PER_S * missed + 0.01 * self._normal
            else:
                is_beside = off > self._aim_m + 0.3 * max(0.0, height)
                down = 0.0 if is_beside else max(0.004, min(0.05, GAIN_PER_S * height))
                velocity = GAIN_PER_S * beside - down * self._outward
            if look.stage is not TouchStage.FAR:
                velocity *= min(1.0, SLOWLY_M_S / float(np.linalg.norm(velocity)))
            self._push(look, velocity)
        return False

    def _press(self) -> None:
        """Press Touch, and see whether it counts; after a refusal lift the tip."""
        trainee = self._trainee
        kept, refused = self._kept, trainee.state.training.rejected
        trainee.tap("touch")
        trainee.until(
            lambda: self._kept > kept or trainee.state.training.rejected > refused, "an answer"
        )
        if self._kept == kept:
            self._lift()

    def _way(self, look: Look, goal: str) -> np.ndarray | None:
        """Return the vector from the tip to a fiducial or to the head's middle, (3,) float, m.

        Each picture tells two of its parts; what neither tells is taken as zero. None if no picture
        shows both the tip and the goal.
        """
        rows, values = [], []
        for picture, remembered in zip((look.main, look.beside), self._goals, strict=True):
            place = picture.spots.get(goal, remembered if goal == "fiducial" else None)
            if place is not None and "tip" in picture.spots:
                rows.extend(picture.axes[:2] / picture.pixel_m)
                values.extend((place - picture.spots["tip"]) / picture.pixel_m)
        if not rows:
            return None
        rows.extend(0.5 * np.eye(3))
        values.extend(np.zeros(3))
        return np.linalg.lstsq(np.array(rows), np.array(values), rcond=None)[0]

    def _push(self, look: Look, velocity: np.ndarray) -> None:
        """Push the sticks for a velocity of the tip, (3,) float, m/s, in World."""
        self._hands.move(look.main.level_axes @ velocity)
