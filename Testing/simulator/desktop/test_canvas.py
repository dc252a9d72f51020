import numpy as np

from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.desktop.panels.canvas import Box, Canvas
from rastrainer_simulator.desktop.panels.theme import BODY, rgba

RED, GREEN = rgba(0xFF0000), rgba(0x00FF00, 0.5)


def test_a_box_covers_its_pixels_and_no_others():
    canvas = Canvas(20, 10)
    canvas.box(Box(5, 2, 10, 6), RED)
    covered = canvas.pixels()[..., 3] == 255
    assert covered.sum() == 60
    assert covered[2:8, 5:15].all()


def test_a_half_transparent_shape_blends_with_what_is_under_it():
    canvas = Canvas(4, 4)
    canvas.box(Box(0, 0, 4, 4), RED)
    canvas.box(Box(0, 0, 4, 4), GREEN)
    assert canvas.pixels()[1, 1].tolist() == [128, 128, 0, 255]


def test_half_transparent_color_alone_keeps_its_hue():
    canvas = Canvas(2, 2)
    canvas.box(Box(0, 0, 2, 2), GREEN)
    assert canvas.pixels()[0, 0].tolist() == [0, 255, 0, 128]


def test_corners_are_rounded_and_the_area_is_that_of_the_shape():
    canvas = Canvas(100, 60)
    canvas.box(Box(0, 0, 100, 60), RED, 20.0)
    opacity = canvas.pixels()[..., 3] / 255.0
    assert opacity[0, 0] == 0.0
    assert abs(opacity.sum() - (6000 - (4 - np.pi) * 400)) < 12


def test_a_frame_is_empty_inside_and_anything_off_the_canvas_is_clipped():
    canvas = Canvas(30, 30)
    canvas.frame(Box(-5, -5, 30, 30), RED, 0.0, 3)
    opacity = canvas.pixels()[..., 3]
    assert opacity[10, 10] == 0
    assert (opacity[22:25, :25] == 255).all()


def test_text_has_the_same_baseline_whatever_its_letters():
    setter = Brush(2.0)
    feet = []
    for text in ("x", "xÅ", "xg"):
        letters = setter.line(text, BODY)
        width = setter.line("x", BODY).coverage.shape[1]
        rows = np.flatnonzero((letters.coverage[:, : width - 1] > 127).any(axis=1))
        feet.append(letters.coverage.shape[0] - rows[-1] - letters.descent)
    assert len(set(feet)) == 1


def test_wrapped_lines_fit_and_lose_no_word():
    setter = Brush(1.0)
    text = "Touch fifteen numbered points on the head, one after the other. " + "W" * 60
    lines = setter.wrap(text, BODY, 300)
    assert max(setter.width(line, BODY) for line in lines) <= 300
    assert "".join(lines).replace(" ", "") == text.replace(" ", "")


def test_a_dollar_sign_does_not_start_a_formula_and_an_overlong_text_ends_in_an_ellipsis():
    setter = Brush(1.0)
    assert setter.width("$x$", BODY) > setter.width("x", BODY)
    fitted = setter.fit("A label that is much too long for its row", BODY, 120)
    assert fitted.endswith("…")
    assert setter.width(fitted, BODY) <= 120
