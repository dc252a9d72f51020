"""A program with all that it starts: asked to end, or ended, as one.

Slicer's Python is a launcher that starts the real one and passes no signal on, so that to end what
was started is not to end what runs. On POSIX the program gets a session, and so a group, of its
own, which what it starts stays in. On Windows they are in one job object.

Slicer's own end ends none of them by itself: a trial that runs outlives a crash of Slicer.
"""

from __future__ import annotations

import subprocess
import sys
from typing import Any

if sys.platform == "win32":
    import ctypes
    from ctypes import wintypes

    OPTIONS: dict[str, Any] = {"creationflags": subprocess.CREATE_NO_WINDOW}
    """Of `subprocess.Popen`; Windows would open a console window for it."""

    _kernel = ctypes.WinDLL("kernel32", use_last_error=True)
    _kernel.CreateJobObjectW.argtypes = [wintypes.LPVOID, wintypes.LPCWSTR]
    _kernel.CreateJobObjectW.restype = wintypes.HANDLE
    _kernel.AssignProcessToJobObject.argtypes = [wintypes.HANDLE, wintypes.HANDLE]
    _kernel.TerminateJobObject.argtypes = [wintypes.HANDLE, wintypes.UINT]

    def endProcess(pid: int, hasOwnGroup: bool, isAsked: bool) -> None:  # noqa: ARG001
        """End a process and all that it has started, at once: see `ProcessGroup.end`."""
        words = ["taskkill", "/F", "/T", "/PID", str(pid)]
        subprocess.Popen(words, stdin=subprocess.DEVNULL, **OPTIONS)

    class ProcessGroup:
        """What `OPTIONS` have started, and all that it starts."""

        def __init__(self, process: subprocess.Popen) -> None:
            """Take the process into a job; what it starts from now on is in it, too."""
            self._job = _kernel.CreateJobObjectW(None, None)
            _kernel.AssignProcessToJobObject(self._job, int(process._handle))

        def end(self) -> None:
            """End them at once: nothing on Windows can ask a program without a window."""
            self.kill()

        def kill(self) -> None:
            """End them at once."""
            _kernel.TerminateJobObject(self._job, 1)

else:
    import contextlib
    import os
    import signal

    OPTIONS: dict[str, Any] = {"start_new_session": True}
    """Of `subprocess.Popen`."""

    def endProcess(pid: int, hasOwnGroup: bool, isAsked: bool) -> None:
        """End a process that this one has not started.

        Args:
            pid: its number.
            hasOwnGroup: whether `OPTIONS` have started it; then all that it has started ends, too.
            isAsked: whether it is asked to end; otherwise it is killed.

        Raises:
            PermissionError: it is another user's.
        """
        number = signal.SIGTERM if isAsked else signal.SIGKILL
        with contextlib.suppress(ProcessLookupError):
            if hasOwnGroup:
                os.killpg(os.getpgid(pid), number)
            else:
                os.kill(pid, number)

    class ProcessGroup:
        """What `OPTIONS` have started, and all that it starts."""

        def __init__(self, process: subprocess.Popen) -> None:
            self._id = process.pid

        def end(self) -> None:
            """Ask them to end."""
            self._send(signal.SIGTERM)

        def kill(self) -> None:
            """End them at once."""
            self._send(signal.SIGKILL)

        def _send(self, number: int) -> None:
            # Where they have all ended, or (macOS) those that have wait to be noticed.
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._id, number)
