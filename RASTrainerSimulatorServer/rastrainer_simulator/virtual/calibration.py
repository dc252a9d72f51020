"""The virtual hand next to measurements of people, quantity by quantity.

The simulated numbers are measured on the motion of the arm: while the hand points to places around
a circle, as in ISO 9241-411, and in whole trials.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy

from rastrainer import transforms
from rastrainer.commands import CommandName, check_arguments
from rastrainer.motion.trajectory import speeds
from rastrainer.motion.trial_motion import effective_throughput
from rastrainer.protocol import FIDUCIAL_COUNT
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.state import NEUTRAL_STICKS, OperatorCommand, OperatorInput
from rastrainer_simulator.statistics.intervals import rms
from rastrainer_simulator.virtual.hand import (
    DECISION_PERIOD_S,
    DEVICES,
    TREMOR_BAND_HZ,
    Hand,
    Skill,
    Tremor,
)
from rastrainer_simulator.virtual.play import play_virtual_trial


@dataclass(frozen=True)
class Quantity:
    """A range measured in people, and what the virtual hand does (`simulated`).

    `fitted` names the parameter that was chosen for it; without one it is held out: a consequence.
    """

    name: str
    unit: str
    least: float
    most: float
    source: str
    fitted: str = ""
    simulated: float = np.nan

    @property
    def holds(self) -> bool:
        return self.least <= self.simulated <= self.most


TREMOR_SOURCE = "Wells et al. 2013 (PMC3989364)"
TREMOR_SIZES = f"tremor 0.05 to 0.2, positioning error 0.14 to 0.29 mm: {TREMOR_SOURCE}"
POINTING = "Soukoreff and MacKenzie 2004 (10.1016/j.ijhcs.2004.09.001)"
RMSE_PER_FLE = math.sqrt(1.0 - 2.0 / FIDUCIAL_COUNT)
LEAST_FLE_MM, MOST_FLE_MM = (round(rmse / RMSE_PER_FLE, 2) for rmse in (1.01, 1.84))
PUBLISHED = (
    Quantity("peak of the hand's tremor", "Hz", *TREMOR_BAND_HZ, TREMOR_SOURCE, "TREMOR_HZ"),
    Quantity("hand's tremor, RMS", "mm", 0.05, 0.3, TREMOR_SIZES, "tremor_mm"),
    Quantity("peak of the moving tip's acceleration", "Hz", *TREMOR_BAND_HZ, TREMOR_SOURCE),
    Quantity("tremor of the moving tip, RMS", "mm", 0.05, 0.3, TREMOR_SIZES),
    Quantity(
        *("tip's power below 2 Hz, share", "", 0.98, 1.0),
        "98.9 % on average (Riviere, Rader and Khosla 1997); the range is ours",
    ),
    Quantity(
        *("reaction time", "s", 0.21, 0.38),
        "simple: Woods et al. 2015 (10.3389/fnhum.2015.00131); recognition: Laming 1968",
        "reaction_s",
    ),
    Quantity(
        *("throughput, joystick", "bit/s", 1.6, 2.55),
        f"2.4 (Ramcharitar and Teather 2017, 10.1145/3027063.3053213); range: {POINTING}",
        "drift_mm_s",
    ),
    Quantity(
        *("throughput, mouse", "bit/s", 3.7, 4.9), f"4.1; range: {POINTING}", "mouse: gain_per_s"
    ),
    Quantity("Fitts' law, r of time and difficulty", "", 0.9, 1.0, "MacKenzie 1992"),
    Quantity(
        *("localization error of a fiducial, RMS", "mm", LEAST_FLE_MM, MOST_FLE_MM),
        "RMSE of the published trainer's desktop trials over √(1 − 2/15)",
        "aim_sd_mm",
    ),
)

TASK, DT, RATE_HZ = "task-1", 0.01, 100.0
AMPLITUDES_MM, PLACES = (25.0, 50.0, 100.0, 150.0), 13
MOVING_MM_S = 5.0
SLOW_HZ, LOWEST_HZ, HIGHEST_HZ = 2.0, 4.0, 20.0
"""End of the slow motion, and where the peak of an acceleration is searched."""
HELD_S = 60.0


def calibrated(setup: SimulationSetup, repeats: int) -> list[Quantity]:
    """Return the published quantities with what the virtual hand does.

    Each circle is pointed to and the trial is played `repeats` times.
    """
    seeds = range(1, repeats + 1)
    tips, errors = zip(*(_trial(setup, seed) for seed in seeds), strict=True)
    tremor = Tremor(Skill().tremor_mm, seed=1)
    held = np.array([tremor.position_mm(time) for time in np.arange(0.0, HELD_S, DT)])
    moving = [_in_band(tip)[speeds(tip, RATE_HZ) > MOVING_MM_S] for tip in tips]
    frequencies, power = _spectrum(tips)
    joystick, mouse = (
        np.array([[pointing(setup, skill, size, seed) for seed in seeds] for size in AMPLITUDES_MM])
        for skill in DEVICES.values()
    )
    simulated = (
        *(_peak_hz([held]), rms(_in_band(held)), _peak_hz(tips), rms(np.concatenate(moving))),
        power[frequencies < SLOW_HZ].sum() / power.sum(),
        *(joystick[..., 1].mean(), joystick[..., 0].mean(), mouse[..., 0].mean()),
        np.corrcoef(joystick[..., 2:].mean(axis=1).T)[0, 1],
        rms(np.concatenate(errors)),
    )
    pairs = zip(PUBLISHED, simulated, strict=True)
    return [replace(one, simulated=float(value)) for one, value in pairs]


def _tip_mm(simulation: Simulation) -> np.ndarray:
    return MM_PER_M * simulation.state.tool_tip_to_world[:3, 3]


def _trial(setup: SimulationSetup, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the tip at each step of a trial, (n, 3) float, World, and the touches' errors, mm."""
    simulation, scenario = Simulation(setup, seed), setup.scenario
    tip: list[np.ndarray] = []
    play_virtual_trial(
        *(simulation, TASK, seed, Skill(), DT), lambda *_: tip.append(_tip_mm(simulation))
    )
    pose = scenario.perturbed_head_to_world(seed)
    fiducials = transforms.apply(pose, scenario.task(TASK).fiducials)
    touches = np.array([touch.position for touch in simulation.state.training.touches])
    return np.array(tip), np.linalg.norm(MM_PER_M * touches - fiducials, axis=1)


def pointing(
    setup: SimulationSetup, skill: Skill, amplitude_mm: float, seed: int
) -> tuple[float, float, float, float]:
    """Point to the places of an upright circle, each time across it; a settled tip goes on.

    Return throughput (bit/s), and mean reaction (s), difficulty (bits) and movement time (s).
    """
    simulation, random = Simulation(setup, seed), np.random.default_rng(seed)
    hand = Hand(skill, random, seed)
    turns = np.pi * np.arange(PLACES) * (PLACES + 1) / PLACES
    circle = np.column_stack([np.zeros(PLACES), np.cos(turns), np.sin(turns)])
    places = _tip_mm(simulation) + amplitude_mm / 2.0 * (circle - circle[0])
    touches, touched_s, moved_s = [], [], []
    for place in places:
        aim = place + skill.aim_sd_mm * random.normal(size=3) * [0.0, 1.0, 1.0]
        moved_s.append(_steer(simulation, hand, skill, aim))
        touches.append(_tip_mm(simulation))
        touched_s.append(simulation.state.sim_time)
    found = effective_throughput(places, np.array(touches), np.array(touched_s))
    distances = np.array(found.effective_distances_mm)
    difficulty = np.log2(distances / found.effective_width_mm + 1.0).mean()
    reaction_s = np.subtract(moved_s[1:], touched_s[:-1]).mean()
    return found.bits_per_s, reaction_s, difficulty, np.diff(touched_s).mean()


def _steer(simulation: Simulation, hand: Hand, skill: Skill, aim: np.ndarray) -> float:
    """Steer the tip to the aim, (3,) float, World, mm; return the time when it started to move."""
    hand.release()
    decides_s = moves_s = simulation.state.sim_time + skill.reaction_s
    started_s = np.inf
    while True:
        now_s, tip, sticks = simulation.state.sim_time, _tip_mm(simulation), NEUTRAL_STICKS
        if now_s >= decides_s:
            decides_s += DECISION_PERIOD_S
            if np.linalg.norm(aim - tip) < skill.settled_mm:
                return started_s
            hand.correct(aim - tip, skill.speed_mm_s)
        if now_s >= moves_s:
            velocity = hand.velocity(now_s, now_s + DT).tolist()
            jog = check_arguments(CommandName.JOG, {"velocityMmS": velocity, "durationS": DT})
            sticks = OperatorInput(commands=(OperatorCommand(CommandName.JOG, jog),))
        simulation.step(DT, sticks)
        if np.linalg.norm(_tip_mm(simulation) - tip) > MOVING_MM_S * DT:
            started_s = min(started_s, simulation.state.sim_time)


def _spectrum(tips: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return frequencies, Hz, and power of positions (n, 3), over all axes, by Welch's method."""
    of_each = [scipy.signal.welch(tip, RATE_HZ, nperseg=2 * int(RATE_HZ), axis=0) for tip in tips]
    return of_each[0][0], np.sum([power.sum(axis=1) for _, power in of_each], axis=0)


def _peak_hz(tips: Sequence[np.ndarray]) -> float:
    """Return the frequency at which the acceleration is largest, as an accelerometer shows it."""
    frequencies, power = _spectrum(tips)
    seen = (frequencies >= LOWEST_HZ) & (frequencies <= HIGHEST_HZ)
    return float(frequencies[seen][(frequencies**4 * power)[seen].argmax()])


def _in_band(tip: np.ndarray) -> np.ndarray:
    """Return the length of positions (n, 3) between 6 and 12 Hz, (n,) float, mm."""
    band = scipy.signal.butter(4, TREMOR_BAND_HZ, "bandpass", fs=RATE_HZ, output="sos")
    return np.linalg.norm(scipy.signal.sosfiltfilt(band, tip, axis=0), axis=1)
