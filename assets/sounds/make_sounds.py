"""Make the sounds of the simulator: `python assets/sounds/make_sounds.py`.

Every sound is a sum of struck or blown notes, so that all of them belong together; they differ in
pitch, direction and rhythm, which people who hear high tones badly can also distinguish.
"""

from pathlib import Path

import numpy as np
from scipy.io import wavfile

RATE_HZ = 32_000
FADE_S = 0.004
LARGEST = 32_767

# Partials: multiple of the pitch, strength, and share of the note's length.
BELL = ((1.0, 1.0, 1.0), (2.0, 0.35, 0.6), (3.01, 0.16, 0.4), (5.4, 0.06, 0.2))
WOOD = ((1.0, 1.0, 1.0), (2.76, 0.25, 0.25), (5.4, 0.08, 0.12))
REED = tuple((n, 1.0 / n, 1.0) for n in range(1, 9))
"""Blown: it is held, where the others die away."""

# The loudest place, 0 to 1, and notes: pitch in Hz, start and length in s, partials.
SOUNDS = {
    "touch": (0.60, (1046.5, 0.0, 0.30, BELL), (1568.0, 0.07, 0.42, BELL)),
    "undo": (0.55, (783.99, 0.0, 0.22, WOOD), (523.25, 0.10, 0.34, WOOD)),
    "proximity": (0.50, (880.0, 0.0, 0.16, WOOD), (880.0, 0.13, 0.20, WOOD)),
    "contact": (
        0.55,
        *((pitch, start, 0.15, REED) for start in (0.0, 0.21) for pitch in (196.0, 198.5)),
    ),
    "on-skin": (0.30, (587.33, 0.0, 0.28, BELL)),
    "error": (0.65, (311.13, 0.0, 0.22, WOOD), (233.08, 0.15, 0.36, WOOD)),
    "finish": (
        0.60,
        *((523.25, 0.0, 0.5, BELL), (659.26, 0.12, 0.5, BELL), (783.99, 0.24, 0.5, BELL)),
        *((1046.5, 0.36, 0.9, BELL), (1318.5, 0.36, 0.7, BELL, 0.4)),
    ),
    "focus": (0.22, (1244.5, 0.0, 0.06, WOOD)),
    "accept": (0.40, (659.26, 0.0, 0.12, WOOD), (987.77, 0.05, 0.2, WOOD)),
}


def samples(peak: float, *notes: tuple) -> np.ndarray:
    """Return a sound as (n,) int16 at RATE_HZ."""
    total = np.zeros(round(max(note[1] + note[2] for note in notes) * RATE_HZ) + 1)
    for note in notes:
        first, sound = round(note[1] * RATE_HZ), tone(*note)
        total[first : first + len(sound)] += sound
    return np.round(total * (peak * LARGEST / np.abs(total).max())).astype("<i2")


def tone(
    pitch: float, _start: float, length: float, timbre: tuple, loud: float = 1.0
) -> np.ndarray:
    times = np.arange(round(length * RATE_HZ)) / RATE_HZ
    sound = np.zeros_like(times)
    for multiple, strength, share in timbre:
        partial = np.sin(2.0 * np.pi * multiple * pitch * times)
        if timbre is not REED:
            partial *= np.exp(-5.0 * times / (share * length))
        sound += strength * partial
    # Without a click at either end.
    return loud * np.minimum(1.0, np.minimum(times, length - times) / FADE_S) * sound


if __name__ == "__main__":
    for name, sound in SOUNDS.items():
        wavfile.write(Path(__file__).with_name(f"{name}.wav"), RATE_HZ, samples(*sound))
