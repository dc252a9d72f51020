"""Does work within a simulation's steps that usually runs in parallel."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from unittest import mock

from rastrainer_simulator.viewpoint import best_view


@contextmanager
def at_once() -> Iterator[None]:
    """Find best views before their trial is shown, and do not wait for the disk.

    Else a simulation at full speed would take more steps meanwhile on a busy machine.
    """

    with mock.patch.object(best_view, "ThreadPoolExecutor", _AtOnce), mock.patch("os.fsync"):
        yield


class _AtOnce:
    def __init__(self, *_how):
        pass

    def submit(self, work, trial, label, q=None):
        """Search for a view; without a posture, do nothing: the preparation can wait."""
        done = Future()
        done.set_result(None if q is None else work(trial, label, q))
        return done
