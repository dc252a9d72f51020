"""How the tests are run: in which order, and when what they leave is collected."""

from __future__ import annotations

import gc
from pathlib import Path

import pytest

from Testing.simulator.igtl.servers import LoopThread

HERE = Path(__file__).parent
LONGEST = ("end_to_end", "web", "security")
"""Folders whose tests start processes, browsers and attacks. They are checked first, so that no
worker waits for one of them in the end."""
TESTS_PER_FULL_COLLECTION = 100

_tests_done = 0


def pytest_configure():
    # Collected wherever Python happens to be, Qt's and VTK's objects would also die in a thread
    # that answers a socket, which ends the process.
    gc.disable()


@pytest.fixture(scope="module")
def loop_thread():
    """An event loop in a thread, so that a test may block."""
    with LoopThread() as thread:
        yield thread


@pytest.hookimpl(trylast=True)
def pytest_runtest_logfinish():
    global _tests_done
    _tests_done += 1
    gc.collect(2 if _tests_done % TESTS_PER_FULL_COLLECTION == 0 else 1)


def pytest_collection_modifyitems(items):
    items.sort(key=lambda item: item.path.relative_to(HERE).parts[0] not in LONGEST)
