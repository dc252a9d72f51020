"""Save pictures of two sections in use: `python -m Testing.end_to_end.module.screenshots DIR`."""

from __future__ import annotations

import contextlib
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

from Testing.end_to_end.module.story import Story
from Testing.pictures import keep_picture
from Testing.slicer.host.host import Host

SECTIONS = ("simulator", "trainees", "scenario", "training", "registration", "plan", "score")
SHOWN_AFTER = {"look_at_registration": "registration", "look_at_score": "score"}
"""The section to show after each step."""
FOLDED = ("advancedGroupBox", "pointListsGroupBox")
"""Groups that a user opens now and then."""
OPTIONS = ("--speed", "4", "--no-views", "--no-gamepad")
"""Not faster: the trainee would seem to pause for long."""
AZIMUTH, ELEVATION, ZOOM = 35.0, 20.0, 1.3
HEAD, DISTANCE_MM = (0.0, -10.0, 30.0), 620.0
WIDTH = 520


@contextlib.contextmanager
def temporary_host() -> Iterator[tuple[Host, Path]]:
    """Run Slicer in a temporary folder's subfolder; yield it and the folder."""
    with tempfile.TemporaryDirectory() as temporary:
        host = Host(Path(temporary, "computer of the instructor"))
        try:
            yield host, Path(temporary)
        finally:
            host.close()


def take(host: Host, path: Path, width: int | None = None) -> None:
    """Save a picture of the window as WebP, under the name of the PNG file."""
    host.window_screenshot(path, *filter(None, [width]))
    keep_picture(path, path.with_suffix(".webp"))


def save_all(folder: Path) -> None:
    """Play the session and save the pictures."""
    with temporary_host() as (host, temporary):
        story = Story(host, temporary, OPTIONS)
        for step in Story.STEPS:
            step(story)
            host.wait_until(lambda: host.text("nextStepButton") != "Scoring…", "it is scored")
            section = SHOWN_AFTER.get(step.__name__)
            if section is None:
                continue
            show_only(host, section)
            if section == "registration":
                host.look_at(HEAD, AZIMUTH, ELEVATION, DISTANCE_MM)
            else:
                host.look_from(AZIMUTH, ELEVATION, ZOOM)
            take(host, folder / f"module-{section}.png", WIDTH)
            show_only(host, *SECTIONS)


def show_only(host: Host, *shown: str) -> None:
    """Fold every section except some."""
    for section in SECTIONS:
        host.find(f"{section}CollapsibleButton").collapsed = section not in shown
    for group in FOLDED:
        host.find(group).collapsed = True
    host.process_events()


if __name__ == "__main__":
    save_all(Path(sys.argv[1]))
