"""Errors at a button: a message box for the user, and no more in Slicer's log than is useful."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Callable, Iterator

import qt
import slicer

from rastrainer.errors import InputError
from rastrainer.slicer.translation import _


@contextlib.contextmanager
def showErrors(message: str, waitCursor: bool = False) -> Iterator[None]:
    """Show what goes wrong in a message box.

    An error of input is one line in Slicer's log. Anything else is a mistake of ours: it is raised
    further, and Slicer logs its traceback. `message` names the failed action.
    """
    problem = ""
    with slicer.util.tryWithErrorDisplay(message, waitCursor=waitCursor):
        try:
            yield
        except InputError as error:
            problem = str(error)
    if not problem:
        return
    logging.error(" ".join(f"{message} {problem}".split()))
    if slicer.util.mainWindow() is not None and not slicer.app.testingEnabled():
        slicer.util.messageBox(
            f"{message}\n\n{problem}", windowTitle=_("Slicer error"), icon=qt.QMessageBox.Critical
        )


def guardedAction(action: Callable[[], object], failure: str) -> Callable[[], None]:
    """Return a function that shows what goes wrong in an action; see `showErrors`."""

    def act() -> None:
        with showErrors(failure):
            action()

    return act
