"""Work that takes a while: the window stays responsive, and its user may cancel it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import slicer

from rastrainer.panels.widgets import connectAsPressed
from rastrainer.progress import Progress
from rastrainer.slicer.translation import _

T = TypeVar("T")


class _CanceledError(Exception):
    """The user has pressed Cancel."""


class CancelableWork:
    """Runs one piece of work at a time.

    Attributes:
        isUnderWay: whether it runs.
    """

    def __init__(
        self, showSentence: Callable[[str], None], show: Progress, showUsable: Callable[[], None]
    ) -> None:
        """Prepare for work.

        Args:
            showSentence: shows a sentence, an empty one where the work has failed.
            show: shows a step's name and the share of the work done.
            showUsable: called when work begins and ends.
        """
        self.isUnderWay = False
        self._isCanceled = False
        self._showSentence, self._show, self._showUsable = showSentence, show, showUsable

    def run(self, work: Callable[[Progress], T]) -> T | None:
        """Return what the work returns, None where the user has canceled it.

        Args:
            work: is given what it reports its progress to, which raises to cancel it.
        """
        self.isUnderWay, self._isCanceled = True, False
        self._showUsable()
        try:
            return work(self._progress)
        except _CanceledError:
            self._showSentence(_("Canceled; nothing has changed."))
            return None
        except BaseException:
            self._showSentence("")
            raise
        finally:
            self.isUnderWay = False
            self._showUsable()

    def connectButton(self, button: Any, start: Callable[[], None]) -> None:
        """Have a button start the work, or cancel what is under way."""
        connectAsPressed(button, lambda: self.cancel if self.isUnderWay else start)

    def cancel(self) -> None:
        """Cancel what is under way, when it next reports its progress."""
        self._isCanceled = True

    def _progress(self, step: str, share: float) -> None:
        self._show(step, share)
        slicer.app.processEvents()
        if self._isCanceled:
            raise _CanceledError
