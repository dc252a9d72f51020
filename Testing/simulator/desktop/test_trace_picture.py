"""What the window draws of a trace: marks, the paint around them, and a ring where to draw next."""

from dataclasses import replace

import numpy as np
import pytest

from rastrainer_simulator.desktop.head_marks import ShownTrace, SkinPaint
from rastrainer_simulator.desktop.viewports import Quality
from rastrainer_simulator.presentation.messages import SkinPlace, TraceNews
from Testing.simulator.desktop.conftest import SCREEN, state_text

MARKS, RING = ((0, 15, 80), (30, 60, 130)), ((240, 210, 50), (255, 235, 100))
PAINT = ((40, 100, 140), (120, 210, 255))
AHEAD = [[x, -98.0, 20.0] for x in np.arange(-20.0, 21.0, 2.0)]
"""Points on the forehead of the ball that is the head, mm."""
WIDE_MM = 60.0
"""The ball has few corners, and only corners are painted."""
NEXT = SkinPlace((0.0, -95.4, -30.0), (0.0, -0.954, -0.3))


def news(points=(), known=0, covered_mm=WIDE_MM, next_place=NEXT):
    return TraceNews(known, points, covered_mm, next_place)


@pytest.fixture
def show(gl_window, inbox, picture):
    """Return a function that shows a trace and returns the pixels of the main picture."""
    times = iter(np.arange(0.0, 1e4, 10.0))
    picture.set_quality(Quality.LOW)

    def show(trace, screen=SCREEN):
        inbox.trace, inbox.screen, inbox.problem = trace, screen, ""
        inbox.take_state(state_text(next=None, touched=[]))
        for now in (float(next(times)), float(next(times))):
            picture.is_due(now)
        picture.draw()
        return gl_window.pixels().astype(int)

    return show


def count(pixels, color):
    low, high = color
    return int(np.all((pixels >= low) & (pixels <= high), axis=2).sum())


def test_marks_paint_and_ring_are_drawn_and_disappear_with_the_trace(show):
    before = show(ShownTrace())
    drawn = show(ShownTrace().with_update(news(AHEAD)))
    for color in (MARKS, PAINT, RING):
        assert count(drawn, color) > count(before, color) + 60
    assert np.array_equal(show(ShownTrace()), before)


def test_with_physically_based_lighting_the_skin_is_painted_too(show, picture):
    picture.set_quality(Quality.MEDIUM)
    before, drawn = show(ShownTrace()), show(ShownTrace().with_update(news(AHEAD)))
    assert count(drawn, PAINT) > count(before, PAINT) + 60


def test_without_guidance_only_marks_are_drawn(show):
    before = show(ShownTrace())
    drawn = show(ShownTrace().with_update(news(AHEAD, covered_mm=0.0, next_place=None)))
    assert count(drawn, MARKS) > count(before, MARKS) + 60
    for color in (PAINT, RING):
        assert abs(count(drawn, color) - count(before, color)) < 20


def test_the_legend_has_a_sample_of_the_paint(show):
    plain = show(ShownTrace())
    legend = show(ShownTrace(), replace(SCREEN, coverage="Within 10 mm of traced points"))
    assert count(legend, PAINT) > count(plain, PAINT) + 60


def test_nothing_is_redrawn_while_the_trace_is_unchanged(show, picture):
    show(ShownTrace().with_update(news(AHEAD)))
    assert not picture.is_due(1e5)


def test_updates_extend_a_trace_and_remove_an_undone_stroke():
    trace = ShownTrace().with_update(news([[1, 2, 3], [4, 5, 6]]))
    longer = trace.with_update(news([[7, 8, 9]], known=2))
    assert longer.points.tolist() == pytest.approx(
        np.array([[1, 2, 3], [4, 5, 6], [7, 8, 9]]) / 1e3
    )
    assert longer.with_update(news(known=1)).points == pytest.approx(np.array([[1, 2, 3]]) / 1e3)
    assert len(longer.with_update(news(known=0)).points) == 0


def test_the_paint_is_the_same_whether_a_trace_arrives_at_once_or_in_pieces():
    vertices = np.random.default_rng(3).uniform(-0.02, 0.02, (500, 3))
    whole, pieces = SkinPaint(), SkinPaint()
    points = [[float(x), 0.0, 0.0] for x in range(-10, 10)]
    trace = ShownTrace().with_update(news(points[:7], covered_mm=10.0))
    assert pieces.cover(vertices, trace)
    assert not pieces.cover(vertices, trace)
    trace = trace.with_update(news(points[7:], 7, 10.0))
    assert pieces.cover(vertices, trace)
    assert whole.cover(vertices, trace)
    assert np.allclose(whole.shares, pieces.shares)
    shorter = trace.with_update(news(known=5, covered_mm=10.0))
    assert pieces.cover(vertices, shorter)
    again = SkinPaint()
    again.cover(vertices, shorter)
    assert np.allclose(again.shares, pieces.shares)
    away = np.linalg.norm(1e3 * vertices[:, None] - np.array(points), axis=2).min(axis=1)
    assert np.allclose(whole.shares, np.clip((10.0 - away) / 5.0, 0.0, 1.0))
