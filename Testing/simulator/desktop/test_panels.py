from dataclasses import replace

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer_simulator.desktop.gl_window import ARM, ICON_SIZE, SKIN, window_icon
from rastrainer_simulator.desktop.panels import strips, theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.desktop.panels.canvas import Thumbnail
from rastrainer_simulator.desktop.panels.item_row import Look, text_color
from rastrainer_simulator.desktop.panels.menu_panel import menu_panel
from rastrainer_simulator.desktop.panels.tool_guidance import target_arrow
from rastrainer_simulator.presentation.screen import (
    Fact,
    Hint,
    Menu,
    MenuItem,
    ScoreTrend,
    ScreenMessage,
    Tone,
)
from Testing.domain.scenario.made_up_scenario import png
from Testing.simulator.desktop.conftest import MENU

SIZES = [(1280, 720), (1920, 1080), (2560, 1440), (3840, 2160), (1024, 768)]
LONG = Menu(
    "bindings",
    "Controls",
    items=tuple(MenuItem(f"row{n}", f"Control {n}", value="ShiftLeft") for n in range(30)),
    focus="row21",
)
WORDY = Menu(
    "result",
    "Result of a trainee with a very long identification",
    ("Sentence after sentence tells what came of it. " * 4,) * 2,
    tuple(Fact(f"Figure {n}", f"{n}.25 mm", Tone.GOOD) for n in range(8)),
    (MenuItem("next", "Next", help="Goes on."), MenuItem("menu", "Menu")),
    "next",
    "gamepad",
)


def paint(menu, size, hovered=""):
    return menu_panel(menu, theme.scale_of(*size), (size[0] - 64, size[1] - 160), hovered)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("menu", [MENU, LONG, WORDY], ids=lambda menu: menu.name)
def test_no_menu_exceeds_its_space_and_its_focus_is_always_visible(menu, size):
    picture = paint(menu, size)
    height, width = picture.pixels.shape[:2]
    assert width <= size[0] - 64
    assert height <= size[1] - 160
    row = picture.rows[menu.focus]
    assert row.top >= 0
    assert row.top + row.height < height
    # Its corners are empty, so that nothing painted reaches the edge.
    assert picture.pixels[0, 0, 3] == 0


def contrast(color, ground):
    """Return the contrast of two sRGB colors, the first over the second (WCAG 2.2)."""

    def luminance(rgb):
        linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in rgb]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    light, dark = sorted((luminance(color[:3]), luminance(ground[:3])), reverse=True)
    return (light + 0.05) / (dark + 0.05)


@pytest.mark.parametrize("focus", ["task-2", "mode"])
def test_a_disabled_item_is_readable_with_and_without_focus(focus):
    picture = paint(replace(MENU, focus=focus), (1920, 1080))
    row, item = picture.rows["task-2"], MENU.items[-1]
    ground = picture.pixels[row.top + row.height // 2, row.left + 8] / 255.0
    look = Look(has_focus=focus == "task-2", is_hovered=False)
    assert contrast(text_color(item, look), ground) >= 4.5


def test_the_keyboard_is_drawn_with_its_used_keys_colored():
    facts = (Fact("Move forward, back", "W / S"), Fact("Touch", "Space"))
    menu = Menu("controls", "Controls", facts=facts, items=MENU.items[:1], picture="keyboard")
    colored = [
        int(np.all(paint(shown, (1920, 1080)).pixels[..., :3] == (31, 116, 232), axis=2).sum())
        for shown in (replace(menu, facts=()), replace(menu, facts=facts[:1]), menu)
    ]
    key = (colored[1] - colored[0]) / 2
    assert key > 500
    assert colored[2] - colored[1] > key


@pytest.mark.parametrize("size", SIZES)
def test_a_long_text_hides_no_choice(size):
    said = "Take more care at the points 5, 7: without these errors all would be 29 % more exact."
    facts = tuple(Fact(f"Expected error at the target {n}", f"{n}.25 mm") for n in range(7))
    items = tuple(MenuItem(name, name) for name in ("next", "worst", "replay", "again", "menu"))
    menu = Menu("result", "P07: Task 1", (said,) * 6, facts, items, "next")
    assert len(paint(menu, size).rows) == len(items)


@pytest.mark.parametrize("size", SIZES[:4])
def test_the_task_menu_is_complete_without_being_wider(size):
    items = tuple(MenuItem(f"row{n}", f"Row {n}", help="So many words. " * 8) for n in range(14))
    tasks = Menu("experiment", "Experiment", items=items, focus="row13")
    picture, few = paint(tasks, size), paint(replace(tasks, items=items[:3]), size)
    assert picture.rows.keys() == {item.name for item in items}
    assert picture.pixels.shape[1] <= few.pixels.shape[1]


def test_a_click_finds_the_item_whose_row_it_hits():
    picture = paint(MENU, (1920, 1080))
    for name, row in picture.rows.items():
        assert picture.item_at(row.left + 3, row.top + row.height / 2) == name
    assert picture.item_at(1, 1) == ""


def test_focus_hover_and_disabled_items_look_different():
    picture = paint(MENU, (1920, 1080), hovered="task-1")
    pixels = picture.pixels.astype(int)

    def ground(name):
        row = picture.rows[name]
        return pixels[row.top + row.height // 2, row.left + 8, :3]

    def brightest(name):
        row = picture.rows[name]
        inside = pixels[row.top + 8 : row.top + row.height - 8, row.left + 20 : row.left + 200]
        return inside[..., :3].sum(axis=2).max()

    assert ground("mode").tolist() == [31, 116, 232]
    assert ground("task-1").sum() > ground("task-2").sum() + 10
    assert brightest("task-2") < 0.75 * brightest("task-1")


def test_the_smallest_letters_are_readable_from_one_meter_away():
    # 0.3 degrees of sight (ISO 9241-303) is 5 mm at 1 m: 19 pixels of a 24-inch screen of 1080.
    sizes = [getattr(theme, name).size for name in ("BODY", "SMALL", "HEADING", "TITLE")]
    assert min(sizes) >= 19


@pytest.mark.parametrize("size", SIZES)
def test_long_sentences_and_many_hints_stay_within_their_space(size):
    brush = Brush(theme.scale_of(*size))
    room = size[0] // 2
    message = ScreenMessage(
        "A sentence that goes on and on about what is to be done. " * 3, Tone.ERROR
    )
    hints = [Hint("D-pad up / D-pad down", f"Action {n}") for n in range(7)]
    painted = (
        strips.instruction(message, brush, room),
        strips.warning(message, brush, room),
        strips.status([f"Fact number {n}" for n in range(9)], brush, room),
        strips.hints((hints, ""), brush, room),
    )
    assert max(pixels.shape[1] for pixels in painted) <= room


def test_the_window_has_its_own_icon_with_a_head_and_the_robot():
    icon = window_icon()
    assert icon.shape == (ICON_SIZE, ICON_SIZE, 4)
    for color in (SKIN, ARM):
        is_that = np.abs(icon[..., :3] - 255.0 * np.array(color[:3])).max(axis=2) < 8
        assert is_that.sum() > 100


def test_tones_are_distinguished_by_color():
    brush = Brush(1.0)
    banners = [
        strips.warning(ScreenMessage("Text", tone), brush, 900)[5, 40, :3].astype(int)
        for tone in (Tone.WARNING, Tone.ERROR)
    ]
    assert np.abs(banners[0] - banners[1]).max() > 50


@pytest.mark.parametrize(("angle", "side"), [(0, (0, 1)), (90, (-1, 0)), (180, (0, -1))])
def test_the_arrow_points_where_the_target_is(angle, side):
    pixels = target_arrow((angle, 43), Brush(1.0)).astype(int)
    yellow = (pixels[..., 0] > 200) & (pixels[..., 2] < 80) & (pixels[..., 3] > 200)
    rows, columns = np.nonzero(yellow)
    middle = (pixels.shape[0] - 1) / 2
    away = np.array([rows.mean() - middle, columns.mean() - middle])
    assert away @ side > 0.9 * np.linalg.norm(away) > 2.0


def test_a_typed_text_shows_its_end_however_long_it_is():
    name = "N" * 200
    item = replace(MENU.items[0], value=name)
    picture = paint(replace(MENU, items=(item,), focus="trainee"), (1280, 720))
    assert picture.pixels.shape[1] <= 1280 - 64


HEADS = Menu(
    "scenario",
    "Heads",
    ("Which head?",),
    items=(
        MenuItem("head mine", "My head", picture="/scenarios/mine.png"),
        MenuItem("back", "Back"),
    ),
    focus="head mine",
)


@pytest.mark.parametrize("size", SIZES)
def test_the_picture_of_the_focused_item_is_shown_beside_the_list(size):
    color = np.array([40, 90, 160])
    room = (size[0] - 64, size[1] - 160)
    thumbnail = Thumbnail.from_png(png(640, 480))
    without, shown = (
        menu_panel(HEADS, theme.scale_of(*size), room, thumbnail=each) for each in (None, thumbnail)
    )
    assert without.pixels.shape == shown.pixels.shape
    assert shown.pixels.shape[0] <= room[1]
    is_picture, was_picture = (
        (np.abs(pixels[..., :3].astype(int) - color) <= 2).all(axis=2)
        for pixels in (shown.pixels, without.pixels)
    )
    assert not was_picture.any()
    rows, columns = np.nonzero(is_picture)
    height, width = np.ptp(rows) + 1, np.ptp(columns) + 1
    assert width / height == pytest.approx(4 / 3, rel=0.02)
    assert width > 0.2 * shown.pixels.shape[1]
    assert columns.max() < shown.rows["head mine"].left


def test_a_file_that_is_not_a_picture_is_refused_with_a_message():
    with pytest.raises(InputError, match="cannot be read"):
        Thumbnail.from_png(b"no picture")


@pytest.mark.parametrize("size", SIZES)
def test_the_trend_has_a_bar_of_matching_height_for_each_score_and_hides_no_task(size):
    scores = (20.0, 40.0, 80.0)
    menu = replace(MENU, trend=ScoreTrend("Scores: 20, 40, 80.", scores, 70.0))
    picture = paint(menu, size)
    assert len(picture.rows) == len(menu.items)
    aside = picture.pixels[:, : picture.rows["mode"].left, :3].astype(int)

    def height_of(tone):
        color = np.round(255 * np.array(theme.TONES[tone][:3]))
        return np.count_nonzero((np.abs(aside - color) <= 2).all(axis=2), axis=0)

    plain, good = height_of(Tone.PLAIN), height_of(Tone.GOOD)
    # The two below the pass mark, then the one that reaches it.
    heights = np.array([*np.unique(plain[plain > 0.5 * plain.max() - 3])[[0, -1]], good.max()])
    assert heights / good.max() == pytest.approx([0.25, 0.5, 1.0], abs=0.04)
