"""The user's choices in the panels, kept from one start of Slicer to the next.

It belongs to the user and this computer, not to the scene: a scene that is closed, or opened from
elsewhere, changes none of it. In particular, no scene says which computer is connected to.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from rastrainer.protocol import DEFAULT_HOST, DEFAULT_PORT, Mode
from rastrainer.registration.fits import RIGID

Value = TypeVar("Value", str, int, bool)


@dataclass(frozen=True)
class Setting(Generic[Value]):
    """One choice: its key in the store, and its default."""

    key: str
    usual: Value


HOST = Setting("RASTrainer/Host", DEFAULT_HOST)
PORT = Setting("RASTrainer/Port", DEFAULT_PORT)
HAS_WINDOW = Setting("RASTrainer/HasWindow", True)
HAS_NETWORK = Setting("RASTrainer/HasNetwork", False)
PROGRAM = Setting("RASTrainer/Program", "")
WHEELS = Setting("RASTrainer/Wheels", "")
INDEX = Setting("RASTrainer/Index", "")
STUDY = Setting("RASTrainer/Study", "")
STUDY_ADDRESS = Setting("RASTrainer/StudyAddress", "")
MODE = Setting("RASTrainer/Mode", Mode.DESKTOP.value)
SCENARIO = Setting("RASTrainer/Scenario", "")
TASK = Setting("RASTrainer/Task", "")
IS_TUTORIAL_FIRST = Setting("RASTrainer/IsTutorialFirst", True)
SLICES_SHOW_NEXT_POINT = Setting("RASTrainer/SlicesShowNextPoint", True)
SLICES_FOLLOW_TOOL = Setting("RASTrainer/SlicesFollowTool", False)
SLICES_LIE_ALONG = Setting("RASTrainer/SlicesLieAlong", True)
FIT = Setting("RASTrainer/Fit", RIGID)
IS_HEAD_COLORED = Setting("RASTrainer/IsHeadColored", False)


class Settings:
    """Reads and writes settings in a store such as `slicer.app.settings()`."""

    def __init__(self, store: Any | None = None) -> None:
        """Use a store with Qt's `value(key)` and `setValue`; without one nothing is kept."""
        self._store = store
        self._kept: dict[str, Any] = {}

    def get(self, setting: Setting[Value]) -> Value:
        """Return the chosen value; the default if none was chosen, or it cannot be read."""
        kept = self._kept.get(setting.key)
        value = kept if self._store is None else self._store.value(setting.key)
        if value is None:
            return setting.usual
        if isinstance(setting.usual, bool):
            # A file of settings holds texts only.
            return str(value).lower() == "true"
        try:
            return type(setting.usual)(value)
        except ValueError:
            return setting.usual

    def set(self, setting: Setting[Value], value: Value) -> None:
        if self._store is None:
            self._kept[setting.key] = value
        else:
            self._store.setValue(setting.key, value)
