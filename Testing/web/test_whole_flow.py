"""A session from the start menu to the result by every input device: fifteen steered touches.

Only the hands act, and Slicer's side registers and scores their touches.
"""

from __future__ import annotations

import pytest

from Testing.web.trainees_on_page import DEVICES, QUEST_2, at_page


@pytest.mark.soak
@pytest.mark.parametrize("name", DEVICES)
def test_a_trial_is_played_registered_and_scored_with(name, tmp_path, browser):
    device = DEVICES[name]
    with at_page(device, browser, tmp_path, "--speed", device.speed) as trainee:
        place, is_worn = trainee.place, "headset" in device.options
        trainee.begin("task-1")
        slicer = place.start_slicer()
        trainee.play_to_result()
        assert slicer.results()["record"]["mode"] == ("hmd" if is_worn else "desktop")
        assert len(place.entries("touch")) == 15
        assert place.operators == {device.operator}
        (registered,) = place.entries("registered")
        display = registered["record"]["display"]
        assert display["kind"] == ("headset" if is_worn else "page")
        assert display["shownFrames"] > 0
        assert display["droppedFrames"] >= 0
        if device.options == QUEST_2:
            assert (display["device"], display["refreshHz"]) == ("Meta Quest 2", 90)
