"""Work that usually runs beside a simulation's steps, done within them."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from unittest import mock

from rastrainer_simulator.viewpoint import best_view


@contextmanager
def at_once() -> Iterator[None]:
    """Have best views found before their trial is shown, and nothing wait for the disk.

    Else a simulation that goes as fast as it can would take more steps meanwhile on a busy machine.
    """

    with mock.patch.object(best_view, "ThreadPoolExecutor", _AtOnce), mock.patch("os.fsync"):
        yield


class _AtOnce:
    def __init__(self, *_how):
        pass

    def submit(self, work, trial, label, q=None):
        """Search for a view; without a posture it is only prepared, which can wait till then."""
        done = Future()
        done.set_result(None if q is None else work(trial, label, q))
        return done
