"""The hand of virtual operators: how it trembles, and what a stick makes of it."""

from dataclasses import replace

import numpy as np
import pytest

from rastrainer_simulator.virtual.hand import DEVICES, TREMOR_BAND_HZ, Hand, Skill, Tremor

STEP_S = 0.01
TIMES_S = np.arange(0.0, 120.0, STEP_S)
JOYSTICK, MOUSE = DEVICES.values()
AHEAD = np.array([1000.0, 0.0, 0.0])


SETTLED_S = 1.0
"""After this time the hand moves at its speed."""


def shaken_mm(skill, fastest_mm_s, step_s=STEP_S, seconds=20.0):
    """Return how far tremor moves the tip from its path at each step, (n, 3) float, mm."""
    velocities = []
    for tremor_mm in (skill.tremor_mm, 0.0):
        still = replace(skill, drift_mm_s=0.0, tremor_mm=tremor_mm)
        hand = Hand(still, np.random.default_rng(1), seed=1)
        hand.correct(AHEAD, fastest_mm_s)
        times = np.arange(round(seconds / step_s)) * step_s
        velocities.append(np.array([hand.velocity(time, time + step_s) for time in times]))
    shaken = np.subtract(*velocities)[times > SETTLED_S - STEP_S / 2]
    return np.cumsum(step_s * shaken, axis=0)


def test_tremor_has_its_size_along_each_axis_and_lies_between_6_and_12_hz():
    tremor = np.array([Tremor(0.12, seed=3).position_mm(time) for time in TIMES_S])
    assert tremor.std(axis=0) == pytest.approx([0.12] * 3, rel=0.05)
    power = (np.abs(np.fft.rfft(tremor, axis=0)) ** 2).sum(axis=1)
    frequencies = np.fft.rfftfreq(len(TIMES_S), STEP_S)
    low, high = TREMOR_BAND_HZ
    in_band = (frequencies > low - 0.1) & (frequencies < high + 0.1)
    assert power[in_band].sum() > 0.99 * power.sum()
    assert 7.0 < np.average(frequencies, weights=power) < 9.5


def test_a_stick_leaves_little_of_the_tremor_and_less_at_low_speed():
    joystick, slow, mouse = (
        shaken_mm(skill, speed).std(axis=0).mean()
        for skill, speed in ((JOYSTICK, 120.0), (JOYSTICK, 16.0), (MOUSE, 120.0))
    )
    assert mouse == pytest.approx(Skill().tremor_mm, rel=0.1)
    assert joystick < 0.7 * mouse
    assert slow == pytest.approx(joystick * 16.0 / 120.0, rel=0.01)
