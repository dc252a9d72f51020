"""Make the film of the README of what `make demo` has written: python -m Testing.readme_film."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from rastrainer.journal.recording import read_track
from rastrainer_simulator.record.trial_context import setup_of
from rastrainer_simulator.replay.film import filmed
from rastrainer_simulator.replay.recorded_trial import RecordedTrial

ROOT = Path(__file__).parents[1]
DEMO = ROOT / "build" / "demo"
FILM = ROOT / "docs" / "film" / "rastrainer.webm"
SIZE, RATE_HZ = (960, 540), 12.5
"""Half the rate of `rastrainer replay --film`, and fewer pixels: the repository holds the film."""
STILL_S = 4.0
FIRST_TOUCHES, SLOW, FAST = 3, 1.5, 10.0
"""Number of touches that are shown slowly, and seconds of the trial per second of the film."""
NIGHT = (14, 23, 38)


def main() -> None:
    """Write the film: the start, three touches, the others, registration, score and electrodes."""
    journal = sorted((DEMO / "records").glob("*.journal"))[-1]
    track = read_track(journal)
    trial = RecordedTrial(track, setup := setup_of(track.header))
    first = track.trajectory.touches[FIRST_TOUCHES - 1].time_s + 1.0
    last = track.trajectory.touches[-1].time_s + 1.0
    times = [*np.arange(0.0, first, SLOW / RATE_HZ), *np.arange(first, last, FAST / RATE_HZ)]
    FILM.parent.mkdir(exist_ok=True)
    encoder = cv2.VideoWriter(str(FILM), cv2.VideoWriter.fourcc(*"VP90"), RATE_HZ, SIZE)
    still(encoder, ROOT / "Screenshots" / "menu.webp", "Choose a task")
    for pixels, time_s in zip(filmed(trial, setup, times), times, strict=True):
        said = "Touch fifteen points on the head" if time_s < first else "Ten times as fast"
        encoder.write(
            captioned(cv2.resize(pixels, SIZE, interpolation=cv2.INTER_AREA), said)[..., ::-1]
        )
    still(encoder, DEMO / "residuals.png", "The touches register the head to its MRI")
    still(encoder, ROOT / "Screenshots" / "result.webp", "Your score: fast, accurate, gentle")
    still(encoder, DEMO / "procedure.png", "Place electrodes with your own registration")
    encoder.release()
    print(FILM, FILM.stat().st_size)


def still(encoder: cv2.VideoWriter, path: Path, caption: str) -> None:
    """Show a picture for some seconds, as large as fits."""
    with Image.open(path) as opened:
        picture = opened.convert("RGB")
    picture.thumbnail(SIZE)
    sheet = Image.new("RGB", SIZE, NIGHT)
    sheet.paste(picture, ((SIZE[0] - picture.width) // 2, (SIZE[1] - picture.height) // 2))
    pixels = captioned(np.asarray(sheet), caption)
    for _ in range(round(STILL_S * RATE_HZ)):
        encoder.write(pixels[..., ::-1])


def captioned(pixels: np.ndarray, caption: str) -> np.ndarray:
    """Return a picture with a line of text at its lower edge."""
    picture = Image.fromarray(pixels)
    drawing = ImageDraw.Draw(picture)
    font = ImageFont.load_default(34)
    left, top, right, bottom = drawing.textbbox((SIZE[0] / 2, SIZE[1] - 44), caption, font, "mm")
    drawing.rounded_rectangle((left - 24, top - 14, right + 24, bottom + 14), 14, NIGHT)
    drawing.text((SIZE[0] / 2, SIZE[1] - 44), caption, (244, 247, 251), font, "mm")
    return np.asarray(picture)


if __name__ == "__main__":
    main()
