"""Page and board have the same texts in every language, with the menus' names of inputs."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from rastrainer_simulator.texts.texts import LANGUAGES

TEXTS = Path(__file__).parents[2] / "RASTrainerSimulatorServer" / "web" / "src" / "texts"
DRAWN = {
    "part.leftStick": "gamepad.leftstick",
    "part.rightStick": "gamepad.rightstick",
    "part.cross": "gamepad.dpup",
    "part.back": "gamepad.back",
    "part.start": "gamepad.start",
    "part.trigger": "headset.fine",
    "part.space": "keyboard.Space",
    "part.enter": "keyboard.Enter",
    "part.backspace": "keyboard.Backspace",
    "part.leftShift": "keyboard.ShiftLeft",
    "part.rightShift": "keyboard.ShiftRight",
}
"""Each colored part of a drawing, and the name of its input in the simulator's menus."""


def tables(language: str) -> list[dict[str, str]]:
    """Return the texts of the page and of the board by their names."""
    texts = json.loads((TEXTS / f"{language}.json").read_text(encoding="utf-8"))
    return [texts["page"], texts["board"]]


@pytest.mark.parametrize("language", LANGUAGES)
def test_the_pages_have_the_same_sentences_with_the_same_placeholders(language):
    for table, english in zip(tables(language), tables("en"), strict=True):
        assert len(english) > 50
        assert table.keys() == english.keys()
        for name, text in english.items():
            assert set(re.findall(r"{\w+}", table[name])) == set(re.findall(r"{\w+}", text)), name


@pytest.mark.parametrize("language", LANGUAGES)
def test_parts_of_a_drawing_and_states_on_the_board_are_named_as_in_the_menus(language):
    page, table = tables(language)[0], LANGUAGES[language]
    for part, name in DRAWN.items():
        assert f"{table[name]} ".startswith(f"{page[part]} "), part
    board = tables(language)[1]
    for state in ("reached", "locked"):
        assert board[f"legend.{state}"].startswith(table[f"assignments.{state}"])
