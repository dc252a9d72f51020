"""Stand-ins written in Python refuse what the measured object of Slicer does not have."""

from __future__ import annotations

from typing import Any


class Checked:
    """Tells apart what Slicer has not, and what only the host does not offer.

    Attributes:
        measured: names of the members of Slicer's object.
        title: what Slicer calls it.
    """

    measured: frozenset[str]
    title: str

    def __getattr__(self, name: str) -> Any:
        if name not in self.measured:
            raise AttributeError(f"Slicer's {self.title} has no {name}.")
        raise NotImplementedError(f"{self.title} has {name}, but the host does not offer it yet.")

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_") and name not in self.measured:
            raise AttributeError(f"Slicer's {self.title} has no {name}.")
        super().__setattr__(name, value)
