"""Which poses one client wants, how often, and which of them it has."""

from __future__ import annotations

from rastrainer.protocol import Rate
from rastrainer_simulator.igtl.pacer import Pacer


class PoseSubscription:
    """One client's wishes; a new one knows of no pose that was sent before.

    Attributes:
        tool_tip: when the tip's pose is due.
        links: when those of the links are.
    """

    def __init__(
        self,
        tool_tip_hz: float = Rate.TOOL_TIP_HZ,
        links_hz: float = Rate.LINKS_HZ,
        is_steady: bool = False,
    ):
        """`is_steady` also wants poses that have not changed."""
        self.tool_tip = Pacer(tool_tip_hz)
        self.links = Pacer(links_hz)
        self._is_steady = is_steady
        self._sent: dict[str, bytes] = {}

    @property
    def next(self) -> float:
        """When the next pose is due, in simulated time."""
        return min(self.tool_tip.next, self.links.next)

    def is_news(self, device: str, content: bytes) -> bool:
        """Return whether a pose is to be sent, which then counts as sent.

        Poses are compared as they travel: what 32 bits do not tell apart has not changed.
        """
        if self._sent.get(device) == content and not self._is_steady:
            return False
        self._sent[device] = content
        return True
