"""The hand of a virtual operator: it steers the tip toward a place, errs and trembles.

Three things move the tip, as measured in people (`calibration.py` has the sources): the voluntary
movement, which closes a share of the remaining distance in equal times, so that the movement time
is linear in the logarithm of the distance (Fitts' law); drift, a slow voluntary error; and
physiological tremor, which reaches the tip through what the hand holds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer_simulator.teleoperation.teleoperation import StickResponse

DECISION_PERIOD_S = 0.05
"""How often the hand corrects its voluntary movement."""
LAG_SHARE = 0.18
"""The muscles' lag, twice, in the time in which a hand closes all but 1/e of the distance: brisk
hands have to lead, or they would swing about the place."""
RESPONSE = StickResponse()
TREMOR_HZ, TREMOR_SPREAD_HZ = 8.1, 1.0
TREMOR_BAND_HZ = (6.0, 12.0)
WAVES = 8
"""Number of sinusoids along each axis."""
_TREMOR = 2
"""Random stream of the tremor: it changes no other draws of a seed."""


@dataclass(frozen=True)
class Skill:
    """The properties of a trainee's hands.

    Attributes:
        gain_per_s: how briskly the remaining distance is closed.
        aim_sd_mm: of the aim on the skin, along each of its two directions.
        settled_mm: largest distance of the tip from its aim for a touch.
        drift_mm_s: SD of the voluntary error of the velocity, along each axis; mostly below 2 Hz.
        tremor_mm: RMS of the hand's physiological tremor, along each axis.
        stick_travel_mm: of the thumb from the stick's center to its end; None for a hand whose
            position the tip follows, as with a mouse.
        overshoot: how far the first aim goes past the fiducial, as a share of the distance.
        dwell_s: how long the tip is held still before a touch.
        slip_at: the fiducial (1 is the first) at which the trainee slips by 4 mm, notices and
            undoes the touch; None for a trainee who never does.
        aim_bias_mm: by what the view misleads the aim; x, y, z in World. The part along the skin
            is what counts.
    """

    speed_mm_s: float = 120.0
    gain_per_s: float = 3.0
    aim_sd_mm: float = 1.0
    settled_mm: float = 0.4
    drift_mm_s: float = 1.8
    tremor_mm: float = 0.12
    stick_travel_mm: float | None = 10.0
    overshoot: float = 0.05
    reaction_s: float = 0.25
    dwell_s: float = 0.3
    slip_at: int | None = 4
    aim_bias_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)


DEVICES = {
    "joystick": Skill(),
    "mouse": Skill(speed_mm_s=300.0, gain_per_s=4.0, drift_mm_s=1.0, stick_travel_mm=None),
}
"""The typical hands, by the device that they hold."""


class Tremor:
    """Physiological tremor: along each axis of World a sum of sinusoids with random phases.

    It is a closed form of time, so that a coarse step of the simulation samples the same tremor as
    a fine one, at no cost.
    """

    def __init__(self, rms_mm: float, seed: int) -> None:
        random = np.random.default_rng([seed, _TREMOR])
        frequencies = random.normal(TREMOR_HZ, TREMOR_SPREAD_HZ, (3, WAVES)).clip(*TREMOR_BAND_HZ)
        self._rates = 2.0 * np.pi * frequencies
        self._phases = random.uniform(0.0, 2.0 * np.pi, (3, WAVES))
        self._amplitude_mm = rms_mm * np.sqrt(2.0 / WAVES)

    def position_mm(self, time_s: float) -> np.ndarray:
        """Return how far the hand is from where it would rest, (3,) float."""
        return self._amplitude_mm * np.sin(self._rates * time_s + self._phases).sum(axis=1)

    def integral_mm_s(self, time_s: float) -> np.ndarray:
        """Return an antiderivative of the position, (3,) float."""
        waves = np.cos(self._rates * time_s + self._phases) / self._rates
        return -self._amplitude_mm * waves.sum(axis=1)


class Hand:
    """Steers the tip by velocities, (3,) float, World, mm/s."""

    def __init__(self, skill: Skill, random: np.random.Generator, seed: int) -> None:
        self._skill, self._random = skill, random
        self._tremor = Tremor(skill.tremor_mm, seed)
        self._drift = np.zeros(3)
        self.release()

    def release(self) -> None:
        """Let go of the stick."""
        self._wanted, self._driven, self._voluntary = np.zeros((3, 3))

    def correct(self, remaining: np.ndarray, fastest_mm_s: float) -> None:
        """Aim at a place, `remaining` mm from the tip, (3,) float; once a decision period.

        The fastest speed belongs to the end of the stick's travel.
        """
        wanted = self._skill.gain_per_s * remaining
        wanted *= min(1.0, fastest_mm_s / max(float(np.linalg.norm(wanted)), 1e-9))
        noise = self._random.normal(0.0, self._skill.drift_mm_s, 3)
        self._drift = 0.6 * self._drift + 0.8 * noise
        self._wanted, self._fastest_mm_s = wanted + self._drift, fastest_mm_s

    def velocity(self, start_s: float, end_s: float) -> np.ndarray:
        """Return the velocity of the tip from one time to the next.

        The voluntary part follows the decision with the lag of the muscles. A stick commands a
        velocity: the robot integrates the tremor of the thumb, which leaves little of it. The
        response of a stick gets steeper with its deflection.
        """
        step_s, travel_mm = end_s - start_s, self._skill.stick_travel_mm
        lags = step_s / (LAG_SHARE / self._skill.gain_per_s)
        driven, voluntary = self._driven - self._wanted, self._voluntary - self._wanted
        self._voluntary = self._wanted + np.exp(-lags) * (voluntary + lags * driven)
        self._driven = self._wanted + np.exp(-lags) * driven
        if travel_mm is None:
            shift = self._tremor.position_mm(end_s) - self._tremor.position_mm(start_s)
            return self._voluntary + shift / step_s
        share = min(1.0, float(np.linalg.norm(self._voluntary)) / self._fastest_mm_s)
        slope = RESPONSE.exponent * share ** (1.0 - 1.0 / RESPONSE.exponent)
        per_s = slope * self._fastest_mm_s / ((1.0 - RESPONSE.dead_zone) * travel_mm)
        shift = self._tremor.integral_mm_s(end_s) - self._tremor.integral_mm_s(start_s)
        return self._voluntary + per_s * shift / step_s
