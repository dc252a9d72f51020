"""On Windows a program is in its job from its first moment on, with all that it starts.

Elsewhere kernel32 is a double, written after Microsoft's documentation: its functions are C
functions of the documented types, so that a wrong type or structure shows.
"""

import ctypes
import gc
import subprocess
import sys
import time
from types import SimpleNamespace

import pytest

from rastrainer.slicer.program import process_group
from rastrainer.slicer.program.process_group import WINDOWS_OPTIONS, WindowsJob

SUSPENDED = 0x4
OTHER_PID = 7
FAR = 1 << 40
"""Handles may have 64 bits."""


class ThreadEntry32(ctypes.Structure):
    """As <tlhelp32.h> declares it."""

    _fields_ = (
        ("dwSize", ctypes.c_uint32),
        ("cntUsage", ctypes.c_uint32),
        ("th32ThreadID", ctypes.c_uint32),
        ("th32OwnerProcessID", ctypes.c_uint32),
        ("tpBasePri", ctypes.c_int32),
        ("tpDeltaPri", ctypes.c_int32),
        ("dwFlags", ctypes.c_uint32),
    )


DOCUMENTED = {
    "CreateJobObjectW": ("_create_job", ctypes.c_void_p, ctypes.c_void_p, ctypes.c_wchar_p),
    "AssignProcessToJobObject": ("_assign", ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p),
    "TerminateJobObject": ("_terminate_job", ctypes.c_int, ctypes.c_void_p, ctypes.c_uint),
    "CreateToolhelp32Snapshot": (
        "_list_threads",
        ctypes.c_void_p,
        ctypes.c_uint32,
        ctypes.c_uint32,
    ),
    "Thread32First": ("_first_thread", ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p),
    "Thread32Next": ("_next_thread", ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p),
    "OpenThread": ("_open_thread", ctypes.c_void_p, ctypes.c_uint32, ctypes.c_int, ctypes.c_uint32),
    "ResumeThread": ("_resume_thread", ctypes.c_uint32, ctypes.c_void_p),
    "CloseHandle": ("_close_handle", ctypes.c_int, ctypes.c_void_p),
}


class Windows:
    """Processes that start a child as soon as they run, and the calls of kernel32.

    Attributes:
        running: numbers of the processes that have been started and not ended.
        refused: names of calls that fail.
        misused: faults in the use of calls.
    """

    def __init__(self):
        self.running = set()
        self.refused = set()
        self.misused = []
        self.open_handles = {}
        self._next = 100
        self._job_of = {}
        self._threads = {1: (OTHER_PID, False)}
        self._listed = {}
        self.kernel = SimpleNamespace(
            **{
                name: ctypes.CFUNCTYPE(*types)(self._refusable(name, getattr(self, own)))
                for name, (own, *types) in DOCUMENTED.items()
            }
        )

    def start(self, creationflags):
        """Start a process as `subprocess.Popen` does."""
        pid = self._process(None, bool(creationflags & SUSPENDED))
        handle = self._handle("process", pid)
        return SimpleNamespace(pid=pid, _handle=handle, kill=lambda: self._end(pid))

    def _number(self):
        self._next += 1
        return self._next

    def _process(self, job, is_suspended):
        pid, thread = self._number(), self._number()
        self.running.add(pid)
        self._job_of[pid] = job
        self._threads[thread] = (pid, is_suspended)
        if not is_suspended:
            self._begin(pid)
        return pid

    def _begin(self, pid):
        # A started process is in the job of its parent.
        child, thread = self._number(), self._number()
        self.running.add(child)
        self._job_of[child] = self._job_of[pid]
        self._threads[thread] = (child, False)

    def _end(self, pid):
        self.running.discard(pid)

    def _handle(self, kind, value):
        handle = FAR + self._number()
        self.open_handles[handle] = (kind, value)
        return handle

    def _of(self, handle, kind):
        found = self.open_handles.get(handle, ("", None))
        assert found[0] == kind, (handle, found, kind)
        return found[1]

    def _refusable(self, name, function):
        failure = ctypes.c_void_p(-1).value if name == "CreateToolhelp32Snapshot" else 0
        failure = 0xFFFFFFFF if name == "ResumeThread" else failure

        def call(*given):
            if name in self.refused:
                return failure
            try:
                return function(*given)
            except Exception as error:  # It would go unnoticed in a function that C calls.
                self.misused.append(f"{name}: {error!r}")
                return failure

        return call

    def _create_job(self, _security, _name):
        return self._handle("job", self._number())

    def _assign(self, job, process):
        self._job_of[self._of(process, "process")] = self._of(job, "job")
        return 1

    def _terminate_job(self, job, _status):
        number = self._of(job, "job")
        self.running -= {pid for pid in self.running if self._job_of[pid] == number}
        return 1

    def _list_threads(self, flags, _pid):
        assert flags == 0x4  # TH32CS_SNAPTHREAD
        return self._handle("snapshot", iter(sorted(self._threads.items())))

    def _first_thread(self, snapshot, entry):
        return self._next_thread(snapshot, entry)

    def _next_thread(self, snapshot, address):
        entry = ThreadEntry32.from_address(address)
        assert entry.dwSize == 28
        thread, (pid, _is_suspended) = next(self._of(snapshot, "snapshot"), (0, (0, False)))
        entry.th32ThreadID, entry.th32OwnerProcessID = thread, pid
        return 1 if thread else 0

    def _open_thread(self, access, _inherits, thread):
        assert access == 0x2  # THREAD_SUSPEND_RESUME
        return self._handle("thread", thread)

    def _resume_thread(self, handle):
        thread = self._of(handle, "thread")
        pid, was_suspended = self._threads[thread]
        self._threads[thread] = (pid, False)
        if was_suspended:
            self._begin(pid)
        return int(was_suspended)

    def _close_handle(self, handle):
        del self.open_handles[handle]
        return 1


@pytest.fixture
def windows():
    windows = Windows()
    yield windows
    assert windows.misused == []


def started(windows):
    process = windows.start(**WINDOWS_OPTIONS)
    return process, WindowsJob(process, windows.kernel)


def test_anything_a_program_starts_in_its_first_moment_ends_with_it(windows):
    _process, job = started(windows)
    assert len(windows.running) == 2
    job.end(isAsked=False)
    assert windows.running == set()


def test_a_program_not_started_suspended_would_leave_its_first_children_behind(windows):
    process = windows.start(0)
    WindowsJob(process, windows.kernel).end(isAsked=False)
    assert len(windows.running) == 1


def test_no_handle_is_leaked_and_closing_the_last_one_ends_nothing(windows):
    process, job = started(windows)
    kinds = sorted(kind for kind, _value in windows.open_handles.values())
    assert kinds == ["job", "process"]
    del job
    gc.collect()
    assert list(windows.open_handles) == [process._handle]
    assert len(windows.running) == 2


@pytest.mark.parametrize("call", ["CreateJobObjectW", "AssignProcessToJobObject"])
def test_without_a_job_a_program_still_runs_and_is_ended_as_a_tree(windows, monkeypatch, call):
    windows.refused.add(call)
    ended = []
    monkeypatch.setattr(process_group, "endTree", ended.append)
    process, job = started(windows)
    assert len(windows.running) == 2
    job.end(isAsked=True)
    assert ended == [process.pid]


@pytest.mark.parametrize("call", ["CreateToolhelp32Snapshot", "OpenThread", "ResumeThread"])
def test_a_program_that_cannot_be_resumed_is_ended_and_reported(windows, call):
    windows.refused.add(call)
    with pytest.raises(OSError, match="does not let it run"):
        started(windows)
    assert windows.running == set()


PARENT = """
import subprocess, sys, time
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])
print(child.pid, flush=True)
time.sleep(600)
"""


@pytest.mark.skipif(sys.platform != "win32", reason="the job objects of Windows itself")
def test_windows_ends_a_program_with_everything_it_started():
    words = [sys.executable, "-c", PARENT]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, **WINDOWS_OPTIONS) as process:
        job = WindowsJob(process)
        child = process.stdout.readline().strip()
        job.end(isAsked=False)
    listed = ["tasklist", "/NH", "/FI", f"PID eq {child}"]
    end = time.monotonic() + 120.0
    while child in subprocess.run(listed, capture_output=True, text=True, check=True).stdout:
        assert time.monotonic() < end
