"""Widgets whose value is a setting: they begin with what was chosen last, and keep each choice."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rastrainer.panels.widgets import chosenData, fillComboBox
from rastrainer.slicer.settings import Setting, Settings


def keepChecked(box: Any, settings: Settings, setting: Setting[bool]) -> None:
    """Let a check box keep whether it is checked."""
    box.checked = settings.get(setting)
    box.connect("toggled(bool)", lambda checked: settings.set(setting, checked))


def keepText(edit: Any, settings: Settings, setting: Setting[str]) -> None:
    """Let a line edit keep its text."""
    edit.text = settings.get(setting)
    edit.connect("textChanged(QString)", lambda text: settings.set(setting, text))


def keepNumber(box: Any, settings: Settings, setting: Setting[int]) -> None:
    """Let a spin box keep its number."""
    box.value = settings.get(setting)
    box.connect("valueChanged(int)", lambda value: settings.set(setting, value))


def keepPath(edit: Any, settings: Settings, setting: Setting[str]) -> None:
    """Let a path edit keep its path."""
    edit.currentPath = settings.get(setting)
    edit.connect("currentPathChanged(QString)", lambda path: settings.set(setting, path))


def keepChosen(
    combo: Any, entries: Sequence[tuple[str, str]], settings: Settings, setting: Setting[str]
) -> None:
    """Let a combo box of these entries (text, data) keep the data of the chosen one."""
    chosen = settings.get(setting)
    known = [data for _text, data in entries]
    fillComboBox(combo, entries, chosen if chosen in known else setting.usual)
    combo.connect("activated(int)", lambda _index: settings.set(setting, chosenData(combo)))
