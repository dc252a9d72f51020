"""The module from setting the simulator up to deleting the trainee, by buttons alone."""

import os
from pathlib import Path

from Testing.end_to_end.module.story import Story
from Testing.slicer.host.fixtures import *  # noqa: F403 (the fixture `host`)


def test_a_whole_session_by_buttons_alone(host, tmp_path):
    story = Story(host, tmp_path)
    pictures = os.environ.get("RASTRAINER_SCREENSHOTS")
    for number, step in enumerate(Story.STEPS, start=1):
        step(story)
        assert host.errors == []
        if pictures:
            host.window_screenshot(Path(pictures, f"{number:02d}-{step.__name__}.png"))
