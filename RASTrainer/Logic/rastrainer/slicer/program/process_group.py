"""Ends a program with all that it has started: its session, or on Windows its tree of processes."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from typing import Any

OPTIONS: dict[str, Any]
"""For `subprocess.Popen`."""

if sys.platform == "win32":
    # Without it, Windows opens a console window.
    OPTIONS = {"creationflags": subprocess.CREATE_NO_WINDOW}

    def endGroup(leader: int, isAsked: bool) -> None:  # noqa: ARG001
        """End a process and its tree at once: nothing can ask a program without a window."""
        words = ["taskkill", "/F", "/T", "/PID", str(leader)]
        subprocess.Popen(words, stdin=subprocess.DEVNULL, **OPTIONS)

    def endProcess(pid: int, hasOwnGroup: bool, isAsked: bool) -> None:  # noqa: ARG001
        endGroup(pid, isAsked)

else:
    OPTIONS = {"start_new_session": True}

    def endGroup(leader: int, isAsked: bool) -> None:
        """Ask a program started with `OPTIONS` and all that it has started to end, or kill them."""
        # They may all have ended; on macOS, those that have may wait to be noticed.
        with contextlib.suppress(ProcessLookupError, PermissionError):
            os.killpg(leader, signal.SIGTERM if isAsked else signal.SIGKILL)

    def endProcess(pid: int, hasOwnGroup: bool, isAsked: bool) -> None:
        """End a process that this one has not started, or raise PermissionError.

        If it was started with `OPTIONS` (`hasOwnGroup`), all that it has started ends, too.
        """
        number = signal.SIGTERM if isAsked else signal.SIGKILL
        with contextlib.suppress(ProcessLookupError):
            if hasOwnGroup:
                os.killpg(os.getpgid(pid), number)
            else:
                os.kill(pid, number)
