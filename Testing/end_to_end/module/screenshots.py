"""Save pictures of two sections at work: `python -m Testing.end_to_end.module.screenshots DIR`."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

from Testing.end_to_end.module.story import Story
from Testing.pictures import keep_picture
from Testing.slicer.host.host import Host

SECTIONS = ("simulator", "trainees", "scenario", "training", "registration", "plan", "score")
SHOWN_AFTER = {"look_at_registration": "registration", "look_at_score": "score"}
"""Which section is shown after which step."""
FOLDED = ("advancedGroupBox", "pointListsGroupBox")
"""Groups that a user opens now and then."""
OPTIONS = ("--speed", "4", "--no-views", "--no-gamepad")
"""Not too fast: the trainee would seem to make a long pause."""
AZIMUTH, ELEVATION, ZOOM = 35.0, 20.0, 1.3
HEAD, DISTANCE_MM = (0.0, -10.0, 30.0), 620.0
WIDTH = 520


def save_all(folder: Path) -> None:
    """Play the session and save the pictures."""
    with tempfile.TemporaryDirectory() as temporary:
        host = Host(Path(temporary, "computer of the instructor"))
        try:
            story = Story(host, Path(temporary), OPTIONS)
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
                picture = folder / f"module-{section}.png"
                host.window_screenshot(picture, WIDTH)
                keep_picture(picture, picture.with_suffix(".webp"))
                show_all(host)
        finally:
            host.close()


def show_only(host: Host, shown: str) -> None:
    """Fold every section except one."""
    for section in SECTIONS:
        host.find(f"{section}CollapsibleButton").collapsed = section != shown
    for group in FOLDED:
        host.find(group).collapsed = True
    host.process_events()


def show_all(host: Host) -> None:
    """Unfold every section."""
    for section in SECTIONS:
        host.find(f"{section}CollapsibleButton").collapsed = False
    host.process_events()


if __name__ == "__main__":
    save_all(Path(sys.argv[1]))
