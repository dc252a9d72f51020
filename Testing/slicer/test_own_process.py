"""Work in a separate process: its results, its errors, its end, and what there is without it."""

import logging
import os
import sys
from pathlib import Path

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.slicer.head.extraction import findHead
from rastrainer.slicer.head.volume import HeadSettings
from rastrainer.slicer.program.child_process import OwnProcess
from Testing.slicer.head.phantoms import phantom

pytestmark = pytest.mark.usefixtures("own_processes")

FIND_HEAD = "rastrainer.slicer.head.extraction:findHead"
PYTHON = Path(sys.executable)
FAILS = """
import os
from rastrainer.errors import InputError
def refuse(progress):
    raise InputError("“µ” cannot be used.")
def end(progress):
    print("Out of paper.", flush=True)
    os._exit(1)
"""
WHOSE = "import os\ndef work(progress):\n    return os.getpid()\n"


def ignore(_step, _share):
    pass


def test_a_head_found_in_a_separate_process_equals_one_found_in_this_process():
    scan, settings = phantom(spacing=(3.0, 3.0, 3.0), size=0.25), HeadSettings()
    received = []
    found = OwnProcess(PYTHON)(FIND_HEAD, lambda *step: received.append(step), scan, settings)
    expected = findHead(scan, settings, ignore)
    assert (found.baseMm, found.threshold) == (expected.baseMm, expected.threshold)
    np.testing.assert_array_equal(found.level, expected.level)
    np.testing.assert_array_equal(found.body, expected.body)
    assert received[-1] == ("Closing tunnels", 0.7)


def test_refused_input_is_reported_in_the_same_words_and_an_early_end_by_its_last_line(
    tmp_path, monkeypatch
):
    (tmp_path / "failing.py").write_text(FAILS, encoding="utf-8")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(InputError, match=r"^“µ” cannot be used\.$"):
        OwnProcess(PYTHON)("failing:refuse", ignore)
    with pytest.raises(InputError, match=r"ended before it was done: Out of paper\."):
        OwnProcess(PYTHON)("failing:end", ignore)


def test_where_no_process_can_be_started_the_work_is_done_here(tmp_path, monkeypatch, caplog):
    (tmp_path / "only_here.py").write_text(WHOSE)
    monkeypatch.syspath_prepend(tmp_path)
    with caplog.at_level(logging.WARNING):
        assert OwnProcess(tmp_path / "nowhere")("only_here:work", ignore) == os.getpid()
    assert "cannot be started: " in caplog.text
