"""The window has a letter for every character of every language."""

import pytest

from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.ops.texts.texts import LANGUAGES

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


def test_what_the_font_lacks_is_noticed():
    assert not is_drawn("\u4e2d")


def test_a_line_is_not_broken_at_a_narrow_space():
    text = "Recalez ces points\u202f: tous"
    for width in range(120, 400, 10):
        assert not any(line.startswith(":") for line in BRUSH.wrap(text, theme.BODY, width)), width
