"""Work that usually runs beside a simulation's steps, done within them."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from unittest import mock

from rastrainer_simulator.viewpoint import best_view


@contextmanager
def at_once() -> Iterator[None]:
    """Have best views found before their trial is shown, and nothing wait for the disk.

    Else a simulation that goes as fast as it can would take more steps meanwhile on a busy machine.
    """

    def look(views, setup, task, head_to_world):
        views._found = {}
        with mock.patch.object(best_view, "raise_thread_priority"):
            views._look(setup, task, head_to_world, views._found)

    with mock.patch.object(best_view.BestViews, "look", look), mock.patch("os.fsync"):
        yield
