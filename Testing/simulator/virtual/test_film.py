"""A recorded trial as a film: `rastrainer replay --film`."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from rastrainer.journal.folder import journals
from rastrainer.journal.recording import read_track
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.replay import film
from rastrainer_simulator.scene.nodes import NEXT
from rastrainer_simulator.virtual.cohort import RECORDS

SPEED = 20.0


@pytest.fixture(scope="module")
def journal(played):
    return journals(played / RECORDS)[0]


def frames_of(path):
    """Return the film's pictures, (n, height, width, 3) uint8."""
    video = cv2.VideoCapture(str(path))
    assert video.get(cv2.CAP_PROP_FPS) == film.RATE_HZ
    found = []
    while (read := video.read())[0]:
        found.append(read[1][..., ::-1])
    return np.array(found)


def next_point_pixels(picture):
    """Return how many pixels have the hue of the next fiducial."""
    near = np.abs(picture.astype(float) / 255 - NEXT.color).max(axis=-1) < 0.2
    return int(near.sum())


def test_a_film_shows_the_trial_at_the_chosen_speed(monkeypatch, tmp_path, journal, capsys):
    monkeypatch.setattr(film, "SIZE", (320, 180))
    monkeypatch.setattr(film, "RATE_HZ", 4)
    target = tmp_path / "trial.webm"
    assert main(["replay", str(journal), "--film", str(target), "--speed", str(SPEED)]) == 0
    assert [path.name for path in tmp_path.iterdir()] == ["trial.webm"]
    assert "100 %" in capsys.readouterr().err
    shown = frames_of(target)
    duration_s = float(read_track(journal).trajectory.times_s[-1])
    assert len(shown) == pytest.approx(duration_s / SPEED * film.RATE_HZ, abs=2)
    moved = np.abs(np.subtract(shown[0], shown[len(shown) // 2], dtype=float))
    assert moved.mean() > 2.0
    assert max(map(next_point_pixels, shown[: len(shown) // 2])) > 5


def test_a_film_of_another_format_is_refused(tmp_path, journal, capsys):
    assert main(["replay", str(journal), "--film", str(tmp_path / "trial.avi")]) == 2
    assert "must be named *.webm" in capsys.readouterr().err
