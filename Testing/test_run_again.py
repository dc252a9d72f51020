"""A run may be saved by running failed tests again, but only if they then pass."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
FLAKY = """
def test_passes_the_second_time(request):
    mark = request.path.with_name("{name}")
    ran = mark.exists()
    mark.touch()
    assert ran
"""
BROKEN = """
def test_always_fails():
    assert False
"""
CRASH = """
import os

def test_ends_its_worker():
    os._exit(1)
"""


@pytest.fixture
def run(tmp_path):
    """Runs test files of these sources and returns the exit status and the output."""

    def run(*sources: str):
        for i, source in enumerate(sources):
            text = source.replace("{name}", f"mark{i}")
            (tmp_path / f"test_file{i}.py").write_text(text, encoding="utf-8")
        (tmp_path / "pytest.ini").write_text("[pytest]\n", encoding="utf-8")
        command = [sys.executable, "-m", "pytest", "-p", "Testing.run_again", "-n", "2"]
        ended = subprocess.run(
            [*command, "--max-worker-restart=0"],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            capture_output=True,
            text=True,
            timeout=600,
        )
        return ended.returncode, ended.stdout

    return run


def test_a_test_that_passes_alone_saves_the_run_and_is_named_last(run):
    status, text = run(FLAKY)
    assert status == 0
    *_, named, verdict = text.strip().splitlines()
    assert named.startswith("FAILED, then PASSED alone: ")
    assert "::test_passes_the_second_time" in named
    assert verdict.startswith("This run passes.")


def test_a_test_that_fails_again_fails_the_run(run):
    status, text = run(FLAKY, BROKEN)
    assert status == 1
    assert "FAILED, then PASSED alone: " in text
    assert "FAILED, then FAILED alone: test_file1.py::test_always_fails" in text


def test_a_run_that_did_not_end_is_not_saved(run):
    status, text = run(FLAKY, CRASH)
    assert status != 0
    assert "This run passes." not in text
