"""The desktop window as its own process, on a virtual display, and the sounds it has played."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
import wave
from pathlib import Path

import numpy as np
from scipy.signal import oaconvolve, resample_poly

from rastrainer_simulator.assets import asset_path
from Testing.end_to_end.virtual_display import VirtualDisplay

COMMAND = (sys.executable, "-m", "rastrainer_simulator.cli.main", "window")
TIMEOUT_S = 300.0


class WindowProcess:
    """`rastrainer window`; ended by the `with` statement.

    Attributes:
        folder: of its pictures, its frame log and what would be heard.
    """

    def __init__(self, display: VirtualDisplay, url: str, key: str, folder: Path, *arguments: str):
        self.folder = folder
        self.folder.mkdir(parents=True, exist_ok=True)
        self._log = folder / "frames.jsonl"
        # A pipe that no one reads would be full after some minutes.
        self._said = tempfile.TemporaryFile("w+")  # noqa: SIM115
        self._process = subprocess.Popen(
            [
                *(*COMMAND, "--connect", url, "--pictures", str(folder)),
                *("--log-folder", str(folder / "logs"), "--frame-log", str(self._log), *arguments),
            ],
            env={
                **os.environ,
                "DISPLAY": display.name,
                "RASTRAINER_VIEW_KEY": key,
                "SDL_AUDIODRIVER": "disk",
                "SDL_DISKAUDIOFILE": str(self.heard),
            },
            stdout=self._said,
            stderr=subprocess.STDOUT,
        )

    def __enter__(self) -> WindowProcess:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.kill()

    @property
    def heard(self) -> Path:
        """The file of what SDL would have played: 16-bit samples."""
        return self.folder / "heard.raw"

    def frames(self) -> list[str]:
        """Return the lines of the frame log so far."""
        return self._log.read_text().splitlines() if self._log.exists() else []

    def wait_for_frames(self, count: int = 1) -> None:
        """Wait until a number of further pictures have been shown."""
        wanted = len(self.frames()) + count
        wait_until(lambda: self._has_ended or len(self.frames()) >= wanted, "a picture")
        assert len(self.frames()) >= wanted, f"The window has ended: {self.stop()}"

    def wait_for_tick(self, tick: int) -> None:
        """Wait until a picture of that tick, or of a later one, has been shown."""
        wait_until(lambda: json.loads(self.frames()[-1])["tick"] >= tick, "a picture of the tick")

    def next_picture(self, known: set[Path], patience_s: float) -> Path:
        """Wait for a picture that is not among those known, and return its path."""
        wait_until(lambda: set(self.folder.glob("*.png")) - known, "a kept picture", patience_s)
        return (set(self.folder.glob("*.png")) - known).pop()

    @property
    def _has_ended(self) -> bool:
        return self._process.poll() is not None

    def kill(self) -> None:
        """End it as a crash would; a second time changes nothing."""
        if not self._has_ended:
            self._process.kill()
            self._process.wait()

    def stop(self) -> tuple[int, str]:
        """Wait for its end; return its exit status and output."""
        status = self._process.wait(TIMEOUT_S)
        self._said.seek(0)
        return status, self._said.read()


def wait_until(condition, what: str, patience_s: float = TIMEOUT_S) -> None:
    give_up = time.monotonic() + patience_s
    while not condition():
        assert time.monotonic() < give_up, f"{what} never came"
        time.sleep(0.01)


PLAYED_HZ, STORED_HZ = 44_100, 32_000
BYTES_A_SECOND = PLAYED_HZ * 2 * 2
"""Of 16-bit samples in two channels."""


def times_heard(path: Path, name: str, volume: float = 0.8) -> int:
    """Return how often a sound was played at a volume, whatever else was to be heard then.

    A busy window plays the same sound twice at once, or one within the other: what is most like
    the sound is counted, by its loudness, and taken out of the rest (matching pursuit).
    """
    samples = np.fromfile(path, "<i2").reshape(-1, 2)[:, 0].astype(float)
    with wave.open(str(asset_path("sounds", f"{name}.wav"))) as file:
        stored = np.frombuffer(file.readframes(file.getnframes()), "<i2").astype(float)
    pattern = resample_poly(stored, PLAYED_HZ, STORED_HZ)
    energy, length = pattern @ pattern, len(pattern)
    # The factor by which the sound must be multiplied to be most like what was heard.
    loudness = np.pad(oaconvolve(samples, pattern[::-1], "valid") / energy, length)
    alike = oaconvolve(pattern, pattern[::-1]) / energy
    count = 0
    while (peak := loudness.max()) > 0.75 * volume:
        count += round(peak / volume)
        start = int(loudness.argmax())
        loudness[start - length + 1 : start + length] -= peak * alike
    return count
