"""At the lowest quality what stands still is reused, and the picture looks as if all was drawn."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from rastrainer_simulator.desktop import kept_view
from rastrainer_simulator.desktop.head_marks import ShownTrace
from rastrainer_simulator.desktop.picture import Picture
from rastrainer_simulator.desktop.viewports import Quality
from Testing.simulator.desktop.conftest import CAMERA, HERE, MENU, SCREEN, state_text
from Testing.simulator.desktop.test_trace_picture import AHEAD, news

BEFORE_FACE, BEHIND = (0.0, -0.2, 0.0, *HERE[3:]), (0.03, 0.2, 0.02, *HERE[3:])
COVERED = {"link_7": (0.0, -0.3, 0.0, *HERE[3:]), "tool": BEFORE_FACE, "head": HERE}
SEEN_THROUGH = {"view": ["link_7"], "inset": []}
TURNED = (0.02, 0.0, 0.01, 0.0, 0.0, 0.2588190, 0.9659258)
SIDE = {**CAMERA, "position": [0.5, -0.6, 0.2]}
TRACE = ShownTrace().with_update(news(AHEAD))
CHANGES = {
    "the tool before the head": {"poses": {"tool": BEFORE_FACE, "head": HERE}},
    "the tool behind it": {"poses": {"tool": BEHIND, "head": HERE}},
    "another point is next": {"next": "3", "touched": ["1", "2"]},
    "a ghost before the head": {"ghost": {"tool": BEFORE_FACE}},
    "a ghost behind it": {"ghost": {"tool": BEHIND}},
    "the head elsewhere": {"poses": {"tool": BEFORE_FACE, "head": TURNED}},
    "a link before the head": {"poses": COVERED},
    "a translucent link": {"poses": COVERED, "translucent": SEEN_THROUGH},
    "another inset": {"inset": SIDE},
    "a turned view": {"view": SIDE},
    "another camera": {"camera": "far"},
    "no inset beside a menu": {"screen": replace(SCREEN, menu=MENU)},
    "a trace on the skin": {"trace": TRACE},
    "a head that is seen through": {"screen": replace(SCREEN, is_head_clear=True)},
    "nothing else": {},
}


@pytest.fixture
def show(gl_window, inbox):
    """Return a function that shows a state in a picture, once or until nothing moves any more."""
    # Always the same brightness of the point that is next.
    times = itertools.count(14.0, 14.0)

    def show(picture, times_drawn=1, screen=SCREEN, trace=None, **changes):
        inbox.screen, inbox.problem, inbox.trace = screen, "", trace or ShownTrace()
        inbox.take_state(state_text(**changes))
        # A camera that starts moving arrives.
        picture.is_due(next(times))
        now = next(times)
        for _time in range(times_drawn):
            picture.is_due(now)
            picture.draw()
        return gl_window.pixels().astype(int)

    yield show
    inbox.trace = ShownTrace()


@pytest.fixture
def make(gl_window, inbox):
    """Return a function that makes a picture of the lowest quality in place of the previous one."""

    def clear():
        for renderer in list(gl_window.render_window.GetRenderers()):
            gl_window.render_window.RemoveRenderer(renderer)

    def make():
        clear()
        return Picture(gl_window, inbox, Quality.LOW)

    yield make
    clear()


def draws_all(picture):
    return bool(picture.viewports.main.GetDraw())


def test_whatever_changes_the_kept_picture_looks_like_a_newly_drawn_one(make, show):
    anew = {}
    for name, changes in CHANGES.items():
        # The first picture of all has nothing to keep.
        picture = make()
        anew[name] = show(picture, **changes)
        assert draws_all(picture)
    picture = make()
    for name, changes in CHANGES.items():
        kept = show(picture, times_drawn=3, **changes)
        assert draws_all(picture) is ("seen through" in name), name
        assert np.abs(kept - anew[name]).max() <= 2, name


def test_a_point_is_seen_through_a_link_in_the_picture_that_the_link_covers(make, show):
    picture = make()
    middle = np.s_[260:280, 470:490]
    bare, covered, through = (
        show(picture, times_drawn=3, inset=CAMERA, **CHANGES[name])
        for name in ("the tool before the head", "a link before the head", "a translucent link")
    )
    assert not draws_all(picture)
    off = [np.abs(pixels[middle] - bare[middle]).mean() for pixels in (covered, through)]
    assert off[1] < 0.5 * off[0]
    box = picture.viewports.inset_box
    inset = np.s_[box.top : box.top + box.height, box.left : box.left + box.width]
    assert np.abs(through[inset] - covered[inset]).max() <= 2


def test_the_rest_is_kept_while_the_arm_moves_but_not_while_the_view_turns(make, show):
    picture = make()
    show(picture, times_drawn=3)
    for x in (0.01, 0.02, 0.03):
        show(picture, poses={"tool": (x, *BEFORE_FACE[1:]), "head": HERE})
        assert not draws_all(picture)
    for x in (0.1, 0.2, 0.3):
        show(picture, view={**CAMERA, "position": [x, -0.8, 0.0]})
        assert draws_all(picture)


def test_a_large_picture_is_coarse_while_the_view_turns_and_then_fine(
    make, show, gl_window, monkeypatch
):
    picture = make()
    fine = show(picture, times_drawn=3, view=SIDE)
    monkeypatch.setattr(kept_view, "MAX_PIXELS", 200_000)
    picture = make()
    coarse = show(picture, view=SIDE)
    assert picture.viewports.main.GetViewport() == (0.0, 0.0, 0.5, 0.5)
    assert np.abs(coarse - fine).max() > 40
    # Nothing has changed, and yet it is drawn again.
    assert picture.is_due(1e6)
    picture.draw()
    sharp = gl_window.pixels().astype(int)
    assert picture.viewports.main.GetViewport() == (0.0, 0.0, 1.0, 1.0)
    assert (np.abs(sharp - fine).max(axis=2) > 2).mean() < 0.005
