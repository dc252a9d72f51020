"""Work that takes a while: the window stays alive meanwhile, and its user may break it off."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import slicer

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
        self, tell: Callable[[str], None], show: Progress, showUsable: Callable[[], None]
    ) -> None:
        """Prepare for work.

        Args:
            tell: shows a sentence; an empty one where the work has failed.
            show: shows a step's name and the share of the work done.
            showUsable: called when work begins and ends.
        """
        self.isUnderWay = False
        self._isCanceled = False
        self._tell, self._show, self._showUsable = tell, show, showUsable

    def run(self, work: Callable[[Progress], T]) -> T | None:
        """Return what the work returns, None where the user has canceled it.

        Args:
            work: is given what it tells its progress, which raises to cancel it.
        """
        self.isUnderWay, self._isCanceled = True, False
        self._showUsable()
        try:
            return work(self._progress)
        except _CanceledError:
            self._tell(_("Canceled; nothing has changed."))
            return None
        except BaseException:
            self._tell("")
            raise
        finally:
            self.isUnderWay = False
            self._showUsable()

    def cancel(self) -> None:
        """Break off what is under way, as soon as it tells its progress."""
        self._isCanceled = True

    def _progress(self, step: str, share: float) -> None:
        self._show(step, share)
        slicer.app.processEvents()
        if self._isCanceled:
            raise _CanceledError
