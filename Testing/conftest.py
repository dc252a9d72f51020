"""How the tests are run: their order, and when their garbage is collected."""

from __future__ import annotations

import gc
import logging
import os
import random
import sys
from importlib import import_module
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from Testing.simulator.net.igtl.servers import LoopThread
from Testing.study_places import postgres_server, study, study_place  # noqa: F401
from Testing.touched_head import touched_head  # noqa: F401

HERE = Path(__file__).parent
WAITING = ("end_to_end", "web", "security")
"""Folders whose tests wait for processes, browsers and attacks."""
SPREAD = 0.85
"""Share of the run over which they are spread: all at once, they would leave processors idle, and
at the end, other workers."""
TESTS_PER_FULL_COLLECTION = 100

# Random examples are the same each time, and none depends on how fast the machine is.
settings.register_profile(
    "seeded",
    derandomize=True,
    deadline=None,
    max_examples=100,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("seeded")

_tests_done = 0


def pytest_configure():
    # If Python collected garbage at any time, Qt's and VTK's objects would also die in a thread
    # that answers a socket, which ends the process.
    gc.disable()


class ContainedFailures(logging.Handler):
    """Records failures after which the rest continues; see `rastrainer.slicer.signal`."""

    def __init__(self) -> None:
        super().__init__()
        self.texts: list[str] = []

    def emit(self, record: logging.LogRecord) -> None:
        self.texts.append(self.format(record))


@pytest.fixture(autouse=True)
def contained_failures():
    """The contained failures; a test that expects them clears the list."""
    handler, logger = ContainedFailures(), logging.getLogger("rastrainer.error_guard")
    logger.addHandler(handler)
    yield handler.texts
    logger.removeHandler(handler)
    assert not handler.texts, handler.texts[0]


@pytest.fixture(autouse=True)
def _slicer_survives():
    """Fail a test in which a part of Slicer would have ended the program."""
    yield
    crash = sys.modules.get("rastrainer_headless.connector")
    crashes = crash.crashes[:] if crash else []
    if crash:
        crash.crashes.clear()
    assert not crashes, f"Slicer would not have survived: {crashes}"


@pytest.fixture(scope="session")
def built_wheel(tmp_path_factory):
    """The wheel of this checkout, built once."""
    sys.path.insert(0, str(HERE.parent / "tools"))
    return import_module("simulator_wheel").build_wheel(tmp_path_factory.mktemp("wheel"))


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
    files = list(dict.fromkeys(item.path for item in items))
    slow = os.environ.get("RASTRAINER_SLOW")
    share = _shuffled(files, slow) if slow else _spread(files)
    items.sort(key=lambda item: share[item.path])


def _shuffled(files, seed):
    draw = random.Random(seed)
    return {path: draw.random() for path in files}


def _spread(files):
    """Return the share of the run after which each file of tests comes."""
    waiting = [path for path in files if path.relative_to(HERE).parts[0] in WAITING]
    others = [path for path in files if path not in set(waiting)]
    share = {path: number / len(others) for number, path in enumerate(others)}
    return share | {path: SPREAD * number / len(waiting) for number, path in enumerate(waiting)}


def pytest_collection_finish():
    # Imported modules stay to the end: no collection needs to look through them.
    gc.freeze()
