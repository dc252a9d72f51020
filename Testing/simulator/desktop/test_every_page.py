"""Every menu, page and dialog, opened, closed and opened again in the window."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from rastrainer_simulator.desktop.inbox import Inbox, LoadedScene, read_parts
from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.desktop.panels.menu_panel import menu_panel
from rastrainer_simulator.desktop.picture import Picture
from rastrainer_simulator.desktop.viewports import Quality
from rastrainer_simulator.presentation.screen import ErrorArrow, Screen, Tone
from Testing.simulator.desktop.conftest import BODIES, FIDUCIALS, VIEWPOINTS, state_text
from Testing.simulator.flow.conftest import loop, outside, presenter, shared  # noqa: F401
from Testing.simulator.flow.every_page import every_screen, names_of_pages
from Testing.simulator.flow.languages import LONGEST_OR_EACH, screens_in


@pytest.fixture
def show(gl_window, glb):
    """Return a function that shows a screen in the window and returns its pixels."""
    inbox = Inbox()
    inbox.bodies = BODIES
    inbox.scene = LoadedScene(read_parts(glb, BODIES), VIEWPOINTS, FIDUCIALS)
    picture = Picture(gl_window, inbox, Quality.LOW)
    times = itertools.count(0.0, 10.0)

    def show(screen):
        inbox.screen, inbox.problem = screen, ""
        inbox.take_state(state_text(next=None))
        # Twice: a camera that starts moving arrives.
        for now in (next(times), next(times)):
            picture.is_due(now)
        picture.draw()
        return gl_window.pixels().astype(int)

    yield show
    for renderer in list(gl_window.render_window.GetRenderers()):
        gl_window.render_window.RemoveRenderer(renderer)


def test_every_page_looks_the_same_when_it_is_opened_again(show, presenter):  # noqa: F811
    screens = every_screen(presenter)
    assert names_of_pages() <= screens.keys()
    empty = show(Screen())
    for name, screen in screens.items():
        first = show(screen)
        show(Screen())
        again = show(screen)
        assert np.array_equal(first, again), name
        assert not np.array_equal(first, empty), name


def test_the_errors_of_the_touches_are_drawn_in_the_color_of_their_size(show):
    tones = (Tone.GOOD, Tone.WARNING, Tone.ERROR)
    arrows = (
        ErrorArrow((x, -0.12, 0.02), (x, -0.12, 0.06), tone)
        for x, tone in zip((-0.05, 0.0, 0.05), tones, strict=True)
    )
    drawn, empty = show(Screen(errors=tuple(arrows))), show(Screen())
    for tone in tones:
        color = np.round(255 * np.array(theme.TONES[tone][:3]))
        with_arrow, without = (
            np.count_nonzero((np.abs(pixels[..., :3] - color) <= 6).all(axis=2))
            for pixels in (drawn, empty)
        )
        assert with_arrow > without + 50, tone


def test_the_name_of_a_checkpoint_is_written_above_its_ball_and_goes_with_it(show):
    place = (-0.05, -0.12, 0.06)
    bare, named = (
        show(Screen(errors=(ErrorArrow(place, place, Tone.GOOD, name),)))
        for name in ("", "Left forehead")
    )
    changed = np.argwhere((bare != named).any(axis=2))
    color = np.round(255 * np.array(theme.TONES[Tone.GOOD][:3]))
    ball = np.argwhere((np.abs(bare[..., :3] - color) <= 6).all(axis=2))
    (top, left), (bottom, right) = changed.min(axis=0), changed.max(axis=0)
    assert right - left > 3 * (bottom - top) > 30
    assert bottom <= ball[:, 0].min() + 2
    assert left < ball[:, 1].mean() < right
    empty = show(Screen())
    assert np.array_equal(show(Screen()), empty)


@pytest.mark.parametrize("language", LONGEST_OR_EACH)
@pytest.mark.parametrize(
    "size",
    [
        (1280, 720),
        pytest.param((1920, 1080), marks=pytest.mark.soak),
        pytest.param((3840, 2160), marks=pytest.mark.soak),
    ],
)
def test_no_item_of_any_page_is_clipped(presenter, monkeypatch, language, size):  # noqa: F811
    clipped = []
    fit = Brush.fit

    def noted(brush, text, style, width):
        fitted = fit(brush, text, style, width)
        clipped.extend([] if fitted == text else [text])
        return fitted

    monkeypatch.setattr(Brush, "fit", noted)
    for screen in screens_in(presenter, language).values():
        if screen.menu is not None:
            menu_panel(screen.menu, theme.scale_of(*size), (size[0] - 64, size[1] - 160))
    assert clipped == []
