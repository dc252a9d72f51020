"""The views of a simulator, and who operates which."""

from __future__ import annotations

from dataclasses import dataclass

from rastrainer_simulator.input.inputs import SIMULATOR_STATION, Source, SourceKind
from rastrainer_simulator.presentation.messages import Hello

LONGEST_WAIT_S = 300.0
"""A picture that has made no progress for so long is not waited for: the view may be broken."""


@dataclass
class OperatedView:
    """A view that has joined; silent once it no longer reports that it draws."""

    hello: Hello
    is_silent: bool = False
    is_touched: bool = False
    yaw_deg: float | None = None
    """Where the eyes of a headset look, from World's x; None before they do."""
    task: str | None = None
    """Whose scene it has loaded, by a share; None if it reports nothing."""
    share: float = 0.0
    waited_s: float = 0.0
    """How long its picture has been awaited since the last progress."""

    def awaited_share(self, dt: float, task: str) -> float | None:
        """Return its share of a task's picture, 0 to 1; None if nothing needs to be awaited."""
        if self.task is None or (self.task, self.share) == (task, 1.0):
            return None
        self.waited_s += dt
        if self.waited_s > LONGEST_WAIT_S:
            return None
        return self.share if self.task == task else 0.0


class OperatedViews:
    """The views that have joined, and who operates which."""

    def __init__(self) -> None:
        self.joined: dict[int, OperatedView] = {}

    def yaw_deg(self, holder: Source | None) -> float | None:
        """Return where the eyes above an operator's controllers look; None without those."""
        if holder is None or holder.kind is not SourceKind.XR or holder.view not in self.joined:
            return None
        return self.joined[holder.view].yaw_deg

    def watched(self, holder: Source | None) -> int | None:
        """Return the view that the trainee looks at: a headset, else the operated view."""
        # A headset whose network broke comes back as another view, long before the first has left.
        heard = [each for each in reversed(self.joined.items()) if not each[1].is_silent]
        by_kind = {view.hello.kind: number for number, view in heard}
        operated = None if holder is None else holder.view
        choices = (by_kind.get("headset"), operated, by_kind.get("desktop"), by_kind.get("page"))
        return next((view for view in choices if view is not None), None)

    def source(self, kind: SourceKind, number: int) -> Source:
        view = self.joined.get(number)
        is_own = view is not None and view.hello.kind == "desktop"
        return Source(kind, SIMULATOR_STATION if is_own else f"view {number}", number)

    def sticks_source(self, number: int, has_screen_sticks: bool) -> Source:
        """Return whose sticks a view sends: a headset's, a touch screen's, or a mouse's.

        A page has its own sticks on a touch screen; for a mouse they have been asked for.
        """
        view = self.joined.get(number)
        if view is None or view.hello.kind == "headset":
            return self.source(SourceKind.XR, number)
        is_for_mouse = has_screen_sticks and not view.is_touched
        if view.hello.kind == "desktop" or is_for_mouse:
            return self.source(SourceKind.MOUSE, number)
        view.is_touched = True
        return self.source(SourceKind.TOUCH_SCREEN, number)

    def hand_source(self, kind: SourceKind, number: int) -> Source:
        """Return what an item was chosen or written with: a finger, where one has been seen."""
        view = self.joined.get(number)
        if view is not None and view.hello.kind == "headset":
            kind = SourceKind.XR
        elif view is not None and view.is_touched:
            kind = SourceKind.TOUCH_SCREEN
        return self.source(kind, number)
