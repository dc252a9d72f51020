"""The window has a letter for every character of every language."""

import pytest

from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.texts.texts import LANGUAGES, Texts

BRUSH = Brush(1.0)


def is_drawn(character: str) -> bool:
    """Return whether a character has ink, or is a space, which has a width."""
    between, beside = (BRUSH.line(text, theme.BODY).coverage for text in (f"x{character}x", "xx"))
    has_ink = between.sum() > 1.05 * beside.sum()
    return has_ink or (character.isspace() and between.shape[1] > beside.shape[1])


@pytest.mark.parametrize("language", LANGUAGES)
def test_every_character_of_a_language_is_in_the_windows_font(language):
    characters = set("".join(LANGUAGES[language].values()))
    assert [repr(character) for character in sorted(characters) if not is_drawn(character)] == []


def test_a_character_missing_from_the_font_is_noticed():
    assert not is_drawn("\u0e01")


def test_a_line_is_not_broken_at_a_narrow_space():
    text = "Recalez ces points\u202f: tous"
    for width in range(120, 400, 10):
        assert not any(line.startswith(":") for line in BRUSH.wrap(text, theme.BODY, width)), width


def test_chinese_is_broken_between_characters_and_no_line_begins_with_a_closing_mark():
    text = LANGUAGES["zh-Hans"]["match.residual and error"] + LANGUAGES["zh-Hans"]["result.own"]
    for width in range(120, 700, 7):
        lines = BRUSH.wrap(text, theme.BODY, width)
        assert all(BRUSH.width(line, theme.BODY) <= width for line in lines), width
        assert not any(line.startswith(tuple("。，、；：？！）”")) for line in lines), width
        assert not any(line.endswith(("（", "“")) for line in lines), width
        assert len(lines[-1].rstrip("。")) > 1, width


def test_a_number_stays_with_its_unit_in_chinese():
    text = Texts(LANGUAGES["zh-Hans"]).say("above the skin", height=12.5, point="13")
    for width in range(200, 600, 10):
        assert any("12.5\u00a0mm" in line for line in BRUSH.wrap(text, theme.BODY, width)), width


def test_chinese_and_latin_letters_share_a_baseline():
    latin, both = (BRUSH.line(text, theme.BODY) for text in ("Hx", "Hx配准"))
    width = latin.coverage.shape[1]
    rows = both.coverage.shape[0] - both.descent - (latin.coverage.shape[0] - latin.descent)
    assert (both.coverage[rows:, :width][: latin.coverage.shape[0]] == latin.coverage).all()


def test_a_bold_chinese_line_has_more_ink_and_the_same_width():
    thin, bold = (BRUSH.line("配准误差", style).coverage for style in (theme.BODY, theme.STRONG))
    assert bold.sum() > 1.1 * thin.sum()
    assert bold.shape == thin.shape
