"""Runs tests that failed once more, each alone; `.ci/run` loads this plugin by `make test AGAIN=1`.

A run passes if at most three tests failed and each of them passes alone. Their names and both
outcomes are its last lines: such a test has to be fixed.
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

MOST = 3
"""More tests that fail are a fault of the product."""


class FailedTests:
    """Collects the tests that failed in this run, in any worker."""

    def __init__(self) -> None:
        self._names: dict[str, None] = {}  # In order; a test and its fixture may both fail.
        self._session: pytest.Session | None = None

    def pytest_sessionstart(self, session):
        self._session = session

    def pytest_runtest_logreport(self, report):
        if report.failed:
            self._names[report.nodeid] = None

    def pytest_collectreport(self, report):
        """Count a file that cannot be imported as a test."""
        self.pytest_runtest_logreport(report)

    def pytest_unconfigure(self):
        """Run them again: after the summary of the run and before its exit status is returned."""
        session = self._session
        if session is None or session.exitstatus != pytest.ExitCode.TESTS_FAILED:
            return
        if not 1 <= len(self._names) <= MOST:
            print(f"\n{len(self._names)} tests failed: more than {MOST} are not run again.")
            return
        root = session.config.rootpath
        fails_again = {name: _fails_alone(name, root) for name in self._names}
        for name, fails in fails_again.items():
            print(f"\nFAILED, then {'FAILED' if fails else 'PASSED'} alone: {name}")
        if not any(fails_again.values()):
            print("This run passes. What passes only alone depends on chance or speed: mend it.")
            session.exitstatus = pytest.ExitCode.OK


def _fails_alone(name: str, root: Path) -> bool:
    words = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", name]
    return subprocess.run(words, cwd=root, check=False).returncode != 0


def pytest_configure(config):
    if not hasattr(config, "workerinput"):  # Only where the workers' outcomes come together.
        config.pluginmanager.register(FailedTests())
