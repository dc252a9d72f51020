"""Make the sounds of the simulator: `python assets/sounds/make_sounds.py`.

Every sound is a sum of struck or blown notes, so that all of them belong together; they differ in
pitch, direction and rhythm, which people who hear high tones badly can also distinguish.
"""

import wave
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

RATE_HZ = 32_000
FADE_S = 0.004
LARGEST = 32_767

BELL = ((1.0, 1.0, 1.0), (2.0, 0.35, 0.6), (3.01, 0.16, 0.4), (5.4, 0.06, 0.2))
WOOD = ((1.0, 1.0, 1.0), (2.76, 0.25, 0.25), (5.4, 0.08, 0.12))
REED = tuple((n, 1.0 / n, 1.0) for n in range(1, 9))


@dataclass(frozen=True)
class Note:
    """One tone of a sound; its pitch in Hz, start and length in s.

    Attributes:
        timbre: partials as (multiple of the pitch, strength, share of the length).
        is_struck: whether it dies away from its start on; else it is held.
        strength: loudness, relative to the other notes.
    """

    pitch: float
    start: float
    length: float
    timbre: Sequence[tuple[float, float, float]] = BELL
    is_struck: bool = True
    strength: float = 1.0


@dataclass(frozen=True)
class Sound:
    """Notes, and how loud the loudest place of their sum is, 0 to 1."""

    notes: tuple[Note, ...]
    peak: float


SOUNDS = {
    "touch": Sound((Note(1046.5, 0.0, 0.30), Note(1568.0, 0.07, 0.42)), 0.60),
    "undo": Sound((Note(783.99, 0.0, 0.22, WOOD), Note(523.25, 0.10, 0.34, WOOD)), 0.55),
    "proximity": Sound((Note(880.0, 0.0, 0.16, WOOD), Note(880.0, 0.13, 0.20, WOOD)), 0.50),
    "contact": Sound(
        tuple(
            Note(pitch, start, 0.15, REED, is_struck=False)
            for start in (0.0, 0.21)
            for pitch in (196.0, 198.5)
        ),
        0.55,
    ),
    "on-skin": Sound((Note(587.33, 0.0, 0.28),), 0.30),
    "error": Sound((Note(311.13, 0.0, 0.22, WOOD), Note(233.08, 0.15, 0.36, WOOD)), 0.65),
    "finish": Sound(
        (
            Note(523.25, 0.0, 0.5),
            Note(659.26, 0.12, 0.5),
            Note(783.99, 0.24, 0.5),
            Note(1046.5, 0.36, 0.9),
            Note(1318.5, 0.36, 0.7, strength=0.4),
        ),
        0.60,
    ),
    "focus": Sound((Note(1244.5, 0.0, 0.06, WOOD),), 0.22),
    "accept": Sound((Note(659.26, 0.0, 0.12, WOOD), Note(987.77, 0.05, 0.2, WOOD)), 0.40),
}


def samples(sound: Sound) -> np.ndarray:
    """Return a sound as (n,) int16 at RATE_HZ."""
    end = max(note.start + note.length for note in sound.notes)
    total = np.zeros(round(end * RATE_HZ) + 1)
    for note in sound.notes:
        first = round(note.start * RATE_HZ)
        tone = _tone(note)
        total[first : first + len(tone)] += tone
    return np.round(total * (sound.peak * LARGEST / np.abs(total).max())).astype("<i2")


def _tone(note: Note) -> np.ndarray:
    times = np.arange(round(note.length * RATE_HZ)) / RATE_HZ
    tone = np.zeros_like(times)
    for multiple, strength, share in note.timbre:
        partial = np.sin(2.0 * np.pi * multiple * note.pitch * times)
        if note.is_struck:
            partial *= np.exp(-5.0 * times / (share * note.length))
        tone += strength * partial
    # Without a click at either end.
    fade = np.minimum(1.0, np.minimum(times, note.length - times) / FADE_S)
    return note.strength * fade * tone


def main() -> None:
    for name, sound in SOUNDS.items():
        with wave.open(str(Path(__file__).with_name(f"{name}.wav")), "wb") as file:
            file.setnchannels(1)
            file.setsampwidth(2)
            file.setframerate(RATE_HZ)
            file.writeframes(samples(sound).tobytes())


if __name__ == "__main__":
    main()
