"""A program and all that it starts, ended together: a session on POSIX, a job object on Windows.

On Windows the program is started suspended and resumed once it is in the job: what it starts is in
it, too. `subprocess` closes the handle of its first thread, which is therefore found by the
process. The calls are those of Microsoft's documentation of kernel32.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import signal
import subprocess
import sys
import weakref
from typing import Any

_BOOL, _LONG, _DWORD = ctypes.c_int32, ctypes.c_int32, ctypes.c_uint32
_HANDLE, _POINTER, _TEXT = ctypes.c_void_p, ctypes.c_void_p, ctypes.c_wchar_p
"""As on Windows, where the tests of these calls run elsewhere, too."""
_CREATE_NO_WINDOW, _CREATE_SUSPENDED = 0x08000000, 0x00000004
"""Without the former, Windows opens a console window."""
WINDOWS_OPTIONS: dict[str, Any] = {"creationflags": _CREATE_NO_WINDOW | _CREATE_SUSPENDED}
"""For `subprocess.Popen`; a `WindowsJob` resumes the program."""
_SNAP_THREADS = 0x00000004
_SUSPEND_RESUME = 0x0002
_INVALID_HANDLE = ctypes.c_void_p(-1).value
_FAILED = 0xFFFFFFFF


class _ThreadEntry(ctypes.Structure):
    """THREADENTRY32."""

    _fields_ = (
        ("dwSize", _DWORD),
        ("cntUsage", _DWORD),
        ("th32ThreadID", _DWORD),
        ("th32OwnerProcessID", _DWORD),
        ("tpBasePri", _LONG),
        ("tpDeltaPri", _LONG),
        ("dwFlags", _DWORD),
    )


_SIGNATURES: dict[str, tuple[Any, ...]] = {
    "CreateJobObjectW": (_HANDLE, _POINTER, _TEXT),
    "AssignProcessToJobObject": (_BOOL, _HANDLE, _HANDLE),
    "TerminateJobObject": (_BOOL, _HANDLE, _DWORD),
    "CreateToolhelp32Snapshot": (_HANDLE, _DWORD, _DWORD),
    "Thread32First": (_BOOL, _HANDLE, ctypes.POINTER(_ThreadEntry)),
    "Thread32Next": (_BOOL, _HANDLE, ctypes.POINTER(_ThreadEntry)),
    "OpenThread": (_HANDLE, _DWORD, _BOOL, _DWORD),
    "ResumeThread": (_DWORD, _HANDLE),
    "CloseHandle": (_BOOL, _HANDLE),
}


class WindowsJob:
    """A process started with `WINDOWS_OPTIONS`, and all that it starts."""

    def __init__(self, process: subprocess.Popen[str], kernel: Any = None) -> None:
        """Put the process into a job, and resume it; `kernel` stands in for kernel32.

        Raises:
            OSError: it could not be resumed; it has been ended.
        """
        if kernel is None and sys.platform == "win32":
            kernel = ctypes.WinDLL("kernel32", use_last_error=True)
        for name, (result, *arguments) in _SIGNATURES.items():
            # A handle has 64 bits, an int only 32.
            function = getattr(kernel, name)
            function.restype, function.argtypes = result, arguments
        self._kernel = kernel
        self._pid = process.pid
        self._job = self._kernel.CreateJobObjectW(None, None)
        if self._job:
            # The last handle to be closed ends nothing: a crash of Slicer leaves the program alone.
            weakref.finalize(self, self._kernel.CloseHandle, self._job)
        handle = int(getattr(process, "_handle"))  # noqa: B009 (there on Windows only)
        self._isInJob = bool(self._job and self._kernel.AssignProcessToJobObject(self._job, handle))
        if not self._resume():
            process.kill()
            raise OSError("Windows has started it, but does not let it run")

    def end(self, isAsked: bool) -> None:  # noqa: ARG002
        """End them at once: nothing on Windows can ask a program without a window."""
        if self._isInJob:
            self._kernel.TerminateJobObject(self._job, 1)
        else:
            endTree(self._pid)

    def _resume(self) -> bool:
        """Resume each thread of the process; return whether one was resumed."""
        kernel = self._kernel
        snapshot = kernel.CreateToolhelp32Snapshot(_SNAP_THREADS, 0)
        if snapshot in (None, _INVALID_HANDLE):
            return False
        entry = _ThreadEntry(dwSize=ctypes.sizeof(_ThreadEntry))
        wasResumed = False
        isThere = kernel.Thread32First(snapshot, ctypes.byref(entry))
        while isThere:
            thread = None
            if entry.th32OwnerProcessID == self._pid:
                thread = kernel.OpenThread(_SUSPEND_RESUME, False, entry.th32ThreadID)
            if thread:
                wasResumed = kernel.ResumeThread(thread) != _FAILED or wasResumed
                kernel.CloseHandle(thread)
            isThere = kernel.Thread32Next(snapshot, ctypes.byref(entry))
        kernel.CloseHandle(snapshot)
        return wasResumed


def endTree(pid: int) -> None:
    """End a process and all that it has started, as far as their parents still run, at once."""
    words = ["taskkill", "/F", "/T", "/PID", str(pid)]
    subprocess.Popen(words, stdin=subprocess.DEVNULL, creationflags=_CREATE_NO_WINDOW)


if sys.platform == "win32":
    OPTIONS = WINDOWS_OPTIONS
    ProcessGroup = WindowsJob

    def endProcess(pid: int, hasOwnGroup: bool, isAsked: bool) -> None:  # noqa: ARG001
        """End a process and all that it has started, at once: see `WindowsJob.end`."""
        endTree(pid)

else:
    OPTIONS: dict[str, Any] = {"start_new_session": True}
    """Of `subprocess.Popen`."""

    def endProcess(pid: int, hasOwnGroup: bool, isAsked: bool) -> None:
        """End a process that this one has not started, or raise PermissionError.

        Args:
            hasOwnGroup: whether `OPTIONS` have started it; then all that it has started ends, too.
            isAsked: whether it is asked to end; otherwise it is killed.
        """
        number = signal.SIGTERM if isAsked else signal.SIGKILL
        with contextlib.suppress(ProcessLookupError):
            if hasOwnGroup:
                os.killpg(os.getpgid(pid), number)
            else:
                os.kill(pid, number)

    class PosixProcessGroup:
        """A process started with `OPTIONS`, and all that it starts."""

        def __init__(self, process: subprocess.Popen[str]) -> None:
            self._id = process.pid

        def end(self, isAsked: bool) -> None:
            # Where they have all ended, or (macOS) those that have wait to be noticed.
            with contextlib.suppress(ProcessLookupError, PermissionError):
                os.killpg(self._id, signal.SIGTERM if isAsked else signal.SIGKILL)

    ProcessGroup = PosixProcessGroup
