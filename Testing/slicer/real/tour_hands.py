"""Works the module by its real widgets, found by their names."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import slicer


class TourError(Exception):
    """Something is not as it should be; the sentence says what."""


class Hands:
    """Clicks, types and waits."""

    def __init__(self, module: Any, unexpected: list[str], patience_s: float) -> None:
        """`unexpected` grows by the text of each unexpected dialog."""
        self.module = module
        self.patience_s = patience_s
        self.clicked: set[str] = set()
        self._unexpected = unexpected
        self._known = 0

    def find(self, name: str) -> Any:
        """Return the widget of that name."""
        return slicer.util.findChild(self.module.parent, name)

    def text(self, name: str) -> str:
        """Return the text of a widget."""
        return self.find(name).text

    def open(self, *names: str) -> None:
        """Open sections and groups, from without to within."""
        for name in names:
            self.find(name).collapsed = False
        self.idle_for(0.1)

    def click(self, name: str) -> None:
        """Click a button or a check box, which must be usable."""
        widget = self.find(name)
        if not widget.enabled:
            raise TourError(f"{name} is disabled: {widget.toolTip}")
        self.clicked.add(name)
        widget.click()
        self.idle_for(0.1)
        self._handle_dialogs()

    def unused_buttons(self) -> list[str]:
        """Return the names of the buttons of the module's forms that were not clicked."""
        forms = Path(self.module.resourcePath("UI")).glob("*.ui")
        buttons = {
            widget.get("name")
            for form in forms
            for widget in ElementTree.parse(form).iter("widget")
            if widget.get("class") == "QPushButton"
        }
        return sorted(buttons - self.clicked)

    def check(self, name: str, wanted: bool = True) -> None:
        """Check a box, or uncheck it."""
        if self.find(name).checked != wanted:
            self.click(name)

    def choose(self, name: str, part: str) -> None:
        """Choose the entry of a combo box that contains `part`, as a user does."""
        combo = self.find(name)
        texts = [combo.itemText(index) for index in range(combo.count)]
        found = [index for index, text in enumerate(texts) if part in text]
        if not found:
            raise TourError(f"{name} offers no “{part}”, only: {', '.join(texts)}.")
        combo.setCurrentIndex(found[0])
        combo.activated.emit(found[0])
        self.idle_for(0.1)

    def idle_for(self, seconds: float) -> None:
        """Let Slicer process its events for some time."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            slicer.app.processEvents()
            # Threads of Python run only while the main thread waits in Python.
            time.sleep(0.005)

    def wait_until(self, condition: Callable[[], Any], what: str, at_least_s: float = 0.0) -> None:
        """Let Slicer process its events until something is true."""
        timeout_s = max(at_least_s, self.patience_s)
        end = time.monotonic() + timeout_s
        while not condition():
            self._handle_dialogs()
            if time.monotonic() > end:
                raise TourError(f"In {timeout_s:g} s it did not happen: {what}.")
            self.idle_for(0.02)

    def wait_for(self, name: str, part: str, at_least_s: float = 0.0) -> None:
        """Wait until the text of a widget contains `part`."""
        self.wait_until(lambda: part in self.text(name), f"{name} says “{part}”", at_least_s)

    def wait_enabled(self, name: str) -> None:
        self.wait_until(lambda: self.find(name).enabled, f"{name} can be used")

    def _handle_dialogs(self) -> None:
        """Raise `TourError` if an unexpected dialog has opened."""
        said = self._unexpected[self._known :]
        self._known = len(self._unexpected)
        if said:
            raise TourError(f"An unexpected dialog has opened: {'; '.join(said)}")

    def must(self, condition: Any, sentence: str) -> None:
        """Raise `TourError` with a message unless something is true."""
        if not condition:
            raise TourError(sentence)
