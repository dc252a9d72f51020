"""The page's real picture behind the head, and the sticks of a view turned by mouse."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from Testing.end_to_end.hands import PageKeys
from Testing.end_to_end.lab import WITHOUT_GRAPHICS, Place
from Testing.end_to_end.window_process import wait_until
from Testing.web.chromium import open_page

SIZE = {"width": 960, "height": 540}
BEHIND = ("9", "10", "11", "12", "13", "14", "15")
MIDDLE = 36
PATIENCE_S = 120


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("best-view")
    with Place(folder, "--speed", "4", limits=WITHOUT_GRAPHICS) as place:
        yield place


@pytest.fixture(scope="module")
def page(place, browser):
    page = open_page(browser, place.url, place.code, size=SIZE)
    yield page
    assert page.problems == []


def count_of_next(page):
    """Return how many pixels in the middle of the picture have the color of the next fiducial."""
    pixels = np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB")).astype(int)
    y, x = SIZE["height"] // 2, SIZE["width"] // 2
    red, green, blue = np.moveaxis(pixels[y - MIDDLE : y + MIDDLE, x - MIDDLE : x + MIDDLE], -1, 0)
    return int(((red > 225) & (green > 170) & (blue < 216) & (green > blue + 40)).sum())


def is_at_best(trainee, label):
    """Return whether both the view and the inset along the skin look at a fiducial."""
    state = trainee.view.state
    place = trainee.place_of(label)
    focus = np.array(state["view"]["focalPoint"])
    return state["inset"] is not None and np.linalg.norm(focus - place) < 1e-3


@pytest.mark.soak
def test_the_page_shows_each_touch_behind_the_head_at_its_best_view(place, page):
    trainee = place.carried_trainee(PageKeys(page))
    trainee.begin("task-5", page)
    page.wait_for_selector("body[data-scene=task-5]")
    trainee.have_touched(8)
    for label in BEHIND:
        trainee.until(lambda at=label: is_at_best(trainee, at), f"the best view of {label}")
        trainee.approach(label, 0.004)
        trainee.lower_onto(label)
        trainee.until(lambda at=label: is_at_best(trainee, at), f"the best view of {label}")
        # The page's camera flies there, and may lag by more than a few pictures.
        wait_until(lambda: count_of_next(page) > 20, f"{label} in the picture", PATIENCE_S)
        assert page.get_attribute("#inset", "data-name") == "Along the skin"
        trainee.have_touched(int(label))
