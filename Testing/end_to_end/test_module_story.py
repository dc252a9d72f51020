"""The module from setting the simulator up to deleting the trainee, by buttons alone."""

from Testing.end_to_end.module.story import Story
from Testing.slicer.host.fixtures import *  # noqa: F403 (the fixture `host`)


def test_a_whole_session_is_done_with_buttons_alone(host, tmp_path):
    story = Story(host, tmp_path)
    for step in Story.STEPS:
        step(story)
        assert host.errors == []
