"""How much of the processor one client's messages may take, whatever they are."""

from __future__ import annotations

_SAVED_AT_MOST_S = 0.02


class ReadingBudget:
    """Time to spend on a client's bytes: it grows steadily, and debts are waited for.

    A client that sends what is costly to read or much of it is thus read later, and never keeps
    the control loop from its ticks. A new client begins with nothing saved, so that connecting
    anew gains nothing.
    """

    def __init__(self, now: float):
        self._saved = 0.0
        self._since = now

    def charge(self, spent: float, share: float, now: float) -> float:
        """Take `spent` seconds off a budget that grows by `share` of the time.

        Returns how long nothing more may be read, in s.
        """
        earned = self._saved + share * (now - self._since)
        self._saved = min(earned, _SAVED_AT_MOST_S) - spent
        self._since = now
        return max(0.0, -self._saved / share)
