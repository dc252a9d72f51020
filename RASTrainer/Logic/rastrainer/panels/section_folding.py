"""Opens the section of the present step, and folds it after it."""

from __future__ import annotations

from typing import Any

from rastrainer.slicer.next_step import Section


class SectionFolding:
    """Folds and opens whenever the work goes on to another section, and leaves all alone between.

    So what the user opens or folds by hand stays so until then. The sections of which no step is
    the next, such as Scenario and Plan, are the user's alone.
    """

    def __init__(self, ui: Any) -> None:
        self._sections = {each: getattr(ui, f"{each.value}CollapsibleButton") for each in Section}
        self._present: Section | None = None

    def follow(self, section: Section) -> None:
        """Open the section of the present step; fold the others where it is another one."""
        if section is self._present:
            return
        self._present = section
        for each, button in self._sections.items():
            button.collapsed = each is not section

    def open(self, section: Section) -> None:
        """Open a section, which may have been folded by hand."""
        self._sections[section].collapsed = False
