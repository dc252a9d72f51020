"""How the window shows the simulator's messages, really rendered but without a display."""

import asyncio
import sys
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer_simulator.desktop.panels.controls_picture import stick_boxes
from rastrainer_simulator.desktop.picture import Pointer
from rastrainer_simulator.desktop.screenshot import Screenshot, save_screenshot
from rastrainer_simulator.desktop.viewports import Quality, first_quality
from rastrainer_simulator.ops.system_paths import chinese_font
from rastrainer_simulator.presentation.look import FLIGHT_S
from rastrainer_simulator.presentation.screen import Hint, Screen
from rastrainer_simulator.scene import nodes
from rastrainer_simulator.state import TOUCH_ERRORS, TouchStage
from Testing.read_png import read_png
from Testing.simulator.desktop.conftest import (
    HERE,
    MENU,
    SCREEN,
    SIZE,
    state_text,
)

BLUE, RED = ((0, 40, 190), (60, 110, 255)), ((170, 0, 0), (255, 70, 70))
NEAR, ON_SKIN = ((66, 157, 247), (82, 173, 255)), ((158, 247, 94), (174, 255, 110))
VIOLET = (95, 60, 150), (190, 160, 255)
GREEN, YELLOW = ((20, 120, 45), (90, 190, 110)), ((220, 170, 0), (255, 255, 215))


@pytest.fixture
def show(gl_window, inbox, picture):
    """Return a function that shows a screen and a state, and returns the pixels."""
    times = iter(np.arange(0.0, 1e4, 10.0))

    def show(screen=SCREEN, **changes):
        inbox.screen, inbox.problem = screen, ""
        inbox.take_state(state_text(**changes))
        # Twice: a camera that starts moving arrives.
        for now in (float(next(times)), float(next(times))):
            picture.is_due(now)
        picture.draw()
        return gl_window.pixels().astype(int)

    return show


def found(pixels, color):
    low, high = color
    return np.argwhere(np.all((pixels >= low) & (pixels <= high), axis=2))


def main_view(pixels):
    """Leave out what is laid over the picture: instruction and inset above, hints below."""
    return pixels[SIZE[1] // 4 : int(SIZE[1] * 0.86), : int(SIZE[0] * 0.75)]


@pytest.mark.parametrize("touch", [stage.value for stage in TouchStage])
def test_the_tip_is_red_only_while_a_touch_goes_wrong(show, touch):
    pixels = main_view(show(touch=touch, clearanceMm=0.0))
    assert (len(found(pixels, BLUE)) > 20) is (touch == "far")
    assert (len(found(pixels, RED)) > 20) is (touch in [stage.value for stage in TOUCH_ERRORS])


def ring_of(pixels, color):
    """Return the width of what has a color around the tip, in pixels; None for nothing."""
    places = found(pixels[130:255, 400:560], color)
    return np.ptp(places[:, 1]) if len(places) else None


def test_a_ring_around_the_tip_closes_as_it_approaches_and_is_green_on_the_skin(show):
    assert ring_of(show(touch="far", clearanceMm=30.0), NEAR) is None
    wide, narrow = (
        ring_of(show(touch="near", clearanceMm=clearance), NEAR) for clearance in (15.0, 5.0)
    )
    # 20 mm and 10 mm in radius, seen at 0.65 m, 30 degrees of sight over the window's height.
    pixels_a_meter = SIZE[1] / (2 * 0.65 * np.tan(np.radians(15)))
    np.testing.assert_allclose(wide, 2 * 0.020 * pixels_a_meter, atol=10)
    np.testing.assert_allclose(narrow, 2 * 0.010 * pixels_a_meter, atol=10)
    on_skin = ring_of(show(touch="on skin", clearanceMm=0.0), ON_SKIN)
    assert on_skin is not None


def test_touched_fiducials_are_green_the_next_is_yellow_and_the_others_neutral(show):
    pixels = main_view(show())
    green, yellow = (found(pixels, color).mean(axis=0) for color in (GREEN, YELLOW))
    # Fiducial 1 is to the left of 2, as the camera sees them.
    assert green[1] < yellow[1] - 20
    after = main_view(show(next="3", touched=["1", "2"]))
    assert len(found(after, GREEN)) > 1.5 * len(found(pixels, GREEN))


def test_the_tool_is_where_the_stream_places_it(show):
    before = found(main_view(show()), BLUE).mean(axis=0)
    moved = {"tool": (0.05, -0.15, 0.05, 0, 0, 0, 1), "head": HERE}
    after = found(main_view(show(poses=moved)), BLUE).mean(axis=0)
    # 50 mm at 0.65 m, 30 degrees of sight over the window's height.
    pixels_a_meter = SIZE[1] / (2 * 0.65 * np.tan(np.radians(15)))
    assert after[1] - before[1] == pytest.approx(0.05 * pixels_a_meter, rel=0.1)


GHOST = {"tool": (0.12, -0.15, -0.05, 0, 0, 0, 1)}


def changed_by_ghost(before, after):
    """Return where two pictures differ, and the mean of the second there."""
    places = np.argwhere(np.abs(main_view(after) - main_view(before)).max(axis=2) > 8)
    return places, main_view(after)[tuple(places.T)].mean(axis=0)


def test_a_transparent_ghost_is_drawn_beside_the_tool_and_disappears_when_it_ends(show):
    alone, both, after = (show(ghost=ghost, next=None) for ghost in (None, GHOST, None))
    places, (red, green, blue) = changed_by_ghost(alone, both)
    pixels_a_meter = SIZE[1] / (2 * 0.65 * np.tan(np.radians(15)))
    beside = found(main_view(both), BLUE).mean(axis=0) + pixels_a_meter * np.array([0.1, 0.12])
    np.testing.assert_allclose(places.mean(axis=0), beside, atol=4)
    assert blue > red > green
    behind = main_view(alone)[tuple(places.T)].mean(axis=0)
    solid = 255 * np.array(nodes.GHOST.color)
    share = np.linalg.norm([red, green, blue] - behind) / np.linalg.norm(solid - behind)
    assert share == pytest.approx(nodes.GHOST_OPACITY, abs=0.2)
    np.testing.assert_array_equal(after, alone)


def test_only_an_error_frames_the_whole_picture_in_red(show):
    edges = {"top": (1, 480), "bottom": (-2, 300), "left": (270, 1), "right": (300, -2)}
    calm, alarmed = show(touch="on skin"), show(touch="too deep")
    for place in edges.values():
        assert alarmed[place][0] > 200 > 100 > alarmed[place][1]
        assert calm[place][1] > 100


def test_an_arrow_points_to_a_target_out_of_sight_and_vanishes_when_it_is_visible(show):
    aside = {"tool": (0, -0.15, 0.05, 0, 0, 0, 1), "head": (-0.6, 0, 0, 0, 0, 0, 1)}
    arrow = found(show(poses=aside)[:, : SIZE[0] // 3], YELLOW)
    assert len(arrow) > 100
    assert arrow[:, 1].mean() < SIZE[0] / 10
    assert len(found(show()[:, : SIZE[0] // 5], YELLOW)) == 0
    without = replace(SCREEN, has_arrow=False)
    assert len(found(show(without, poses=aside)[:, : SIZE[0] // 3], YELLOW)) == 0


def test_the_inset_shows_the_other_camera_in_a_white_frame_and_gives_way_to_a_menu(show):
    pixels = show()
    right = pixels[: SIZE[1] // 3, int(SIZE[0] * 0.75) :]
    white = found(right, ((250, 250, 250), (255, 255, 255)))
    (top, left), (bottom, end) = white.min(axis=0), white.max(axis=0)
    assert end - left > 150
    assert bottom - top > 90
    assert len(found(right[top + 4 : bottom - 4], BLUE)) > 0
    without = show(screen=SCREEN.__class__(menu=MENU))
    assert len(found(without[: SIZE[1] // 3], ((250, 250, 250), (255, 255, 255)))) < 200


def test_a_clickable_hint_is_found_under_the_mouse(show, picture):
    hints = (Hint("Left / Right", "Turn the view"), Hint("Esc", "Result", "back"))
    show(replace(SCREEN, hints=hints))
    overlay = picture._overlay
    is_item = [[overlay.item_at(x, y) for x in range(SIZE[0])] for y in range(480, 540)]
    places = np.argwhere(np.array(is_item) != "")
    left, right = places[:, 1].min(), places[:, 1].max()
    # It is the right one of two, and as wide as its words.
    assert SIZE[0] / 2 - 20 < left < right < 0.75 * SIZE[0]
    assert 60 < right - left < 160
    assert 15 < np.ptp(places[:, 0]) < 40
    height = 480 + round(places[:, 0].mean())
    assert overlay.item_at((left + right) / 2, height) == "back"
    show()
    assert overlay.item_at((left + right) / 2, height) == ""


def test_a_click_before_the_next_menu_is_drawn_chooses_nothing_from_the_previous_one(
    show, picture, monkeypatch
):
    show(Screen(menu=MENU))
    overlay, inbox = picture._overlay, picture._inbox
    monkeypatch.setattr(picture, "pointer", Pointer())
    grid = [(x, y) for y in range(0, SIZE[1], 10) for x in range(0, SIZE[0], 10)]
    place = next(place for place in grid if overlay.item_at(*place))
    picture.pointer.move(place, 0.0)
    item = picture.item_to_choose(0.0)
    assert item == overlay.item_at(*place)
    inbox.screen = SCREEN
    assert picture.item_at_pointer(0.0) == item
    assert picture.item_to_choose(0.0) == ""
    inbox.screen = Screen(menu=replace(MENU, name="another"))
    assert picture.item_to_choose(0.0) == ""
    assert picture.is_due(1e6)
    assert picture.draw()
    assert picture.item_to_choose(0.0) == item
    assert not picture.draw()


def test_the_on_screen_sticks_are_drawn_as_deflected_in_the_window_that_has_control(show, picture):
    inbox = picture._inbox
    inbox.has_control = True
    blue = ((15, 95, 220), (60, 130, 245))
    drawn = show(replace(SCREEN, has_sticks=True))
    assert picture.has_sticks
    boxes = stick_boxes(SIZE)
    left, right = (
        found(drawn[box.top : box.top + box.height, box.left : box.left + box.width], blue)
        for box in boxes
    )
    assert min(len(left), len(right)) > 500
    picture.pushes = ((1.0, 0.0), (0.0, 0.0))
    box = boxes[0]
    pushed = show(replace(SCREEN, has_sticks=True))
    pushed = pushed[box.top : box.top + box.height, box.left : box.left + box.width]
    assert found(pushed, blue)[:, 1].mean() > left[:, 1].mean() + 0.2 * box.width
    inbox.has_control = False
    without = show(replace(SCREEN, has_sticks=True))
    without = without[box.top : box.top + box.height, box.left : box.left + box.width]
    assert len(found(without, blue)) < 50


def test_a_reopened_menu_is_shown_again(show):
    focused = ((30, 115, 231), (32, 117, 233))
    first = len(found(show(Screen(menu=MENU)), focused))
    without = len(found(show(Screen()), focused))
    again = len(found(show(Screen(menu=MENU)), focused))
    assert again == first > 1000 > without


def test_nothing_is_redrawn_while_nothing_changes(show, picture, inbox):
    show(next=None)
    assert not picture.is_due(1e5)
    inbox.take_state(state_text(next=None, tick=99))
    assert not picture.is_due(1e5)
    inbox.take_state(state_text(next=None, touch="near"))
    assert picture.is_due(1e5)


def test_the_next_fiducial_pulses(show, picture, gl_window):
    show()
    shades = []
    for now in (2e5, 2e5 + 0.35, 2e5 + 0.7):
        assert picture.is_due(now)
        picture.draw()
        # The fiducial is in the middle of the picture.
        shades.append(int(gl_window.pixels()[SIZE[1] // 2, SIZE[0] // 2, 2]))
    assert max(shades) - min(shades) > 40


def test_the_camera_flies_to_its_destination_and_arrives(show, picture, inbox):
    show()
    inbox.take_state(state_text(camera="far"))
    distances = []
    for now in (3e5, 3e5 + FLIGHT_S / 2, 3e5 + FLIGHT_S):
        picture.is_due(now)
        distances.append(-picture.viewports.main.GetActiveCamera().GetPosition()[1])
    np.testing.assert_allclose(distances, [0.8, 1.6, 2.4], atol=1e-6)
    assert not picture.viewports.is_moving(3e5 + FLIGHT_S)


def test_a_lost_connection_is_shown(show, picture, gl_window, inbox):
    before = show()
    inbox.problem = "window.lost"
    assert picture.is_due(4e5)
    picture.draw()
    panel = gl_window.pixels().astype(int)[SIZE[1] // 2, 100:300]
    assert panel.mean() < 80 < before[SIZE[1] // 2, 100:300].mean()
    inbox.problem = ""


def test_a_kept_picture_looks_the_same_in_the_best_lighting(show, inbox, tmp_path):
    plain = show(ghost=GHOST)
    path = tmp_path / "pictures" / "kept.png"
    asyncio.run(save_screenshot(Screenshot.of(inbox, path, SIZE, Quality.HIGH)))
    best = read_png(path).astype(int)
    assert np.abs(best - plain).mean() > 3
    tips = [found(main_view(pixels), BLUE).mean(axis=0) for pixels in (plain, best)]
    assert np.abs(tips[0] - tips[1]).max() < 2
    ghosts = [found(pixels[280:380, 620:720], VIOLET).mean(axis=0) for pixels in (plain, best)]
    assert np.abs(ghosts[0] - ghosts[1]).max() < 8


def test_a_picture_that_cannot_be_kept_is_reported_in_one_sentence(show, inbox, tmp_path):
    show()
    (tmp_path / "file").touch()
    still = Screenshot.of(inbox, tmp_path / "file" / "kept.png", SIZE, Quality.LOW)
    with pytest.raises(InputError, match=r"^The folder .*file cannot be made: .*\.$"):
        asyncio.run(save_screenshot(still))


@pytest.mark.parametrize(
    ("name", "quality"),
    [
        ("llvmpipe (LLVM 15.0.6, 256 bits)", Quality.LOW),
        ("Google SwiftShader", Quality.LOW),
        ("GDI Generic", Quality.LOW),
        ("Mesa Intel(R) UHD Graphics 620 (KBL GT2)", Quality.HIGH),
        ("NVIDIA GeForce RTX 3060/PCIe/SSE2", Quality.HIGH),
    ],
)
def test_software_rendering_is_recognized(name, quality):
    assert first_quality(name) is quality


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere a font is always there")
def test_without_a_chinese_font_the_window_says_so_in_english(show, picture, monkeypatch, tmp_path):
    show(replace(SCREEN, language="zh-Hans"))
    assert picture._content(0.0).screen.menu is None
    with monkeypatch.context() as patch:
        patch.setenv("PATH", str(tmp_path))
        chinese_font.cache_clear()
        (sentence,) = picture._content(0.0).screen.menu.paragraphs
        assert sentence.startswith("This computer has no font with Chinese characters")
    chinese_font.cache_clear()
