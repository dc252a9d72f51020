"""Work in a separate process: its results, its errors, its end, and what there is without it."""

import logging
import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.slicer.head.extraction import findHead
from rastrainer.slicer.head.volume import HeadSettings
from rastrainer.slicer.program.child_process import LOGIC, OwnProcess
from Testing.slicer.head.phantoms import phantom

pytestmark = pytest.mark.usefixtures("own_processes")

FIND_HEAD = "rastrainer.slicer.head.extraction:findHead"
PYTHON = Path(sys.executable)
REFUSES = """
from rastrainer.errors import InputError
def work(progress):
    raise InputError("“µ” cannot be used.")
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


def test_unusable_input_is_refused_in_the_same_words(tmp_path, monkeypatch):
    (tmp_path / "refusing.py").write_text(REFUSES, encoding="utf-8")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(InputError, match=r"^“µ” cannot be used\.$"):
        OwnProcess(PYTHON)("refusing:work", ignore)


def test_a_process_that_ends_before_finishing_is_reported(tmp_path, monkeypatch):
    (tmp_path / "failing.py").write_text(
        "import os\ndef work(progress):\n    print('Out of paper.', flush=True)\n    os._exit(1)\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(InputError, match=r"ended before it was done: Out of paper\."):
        OwnProcess(PYTHON)("failing:work", ignore)


def test_where_no_process_can_be_started_the_work_is_done_here(tmp_path, monkeypatch, caplog):
    (tmp_path / "only_here.py").write_text(WHOSE)
    monkeypatch.syspath_prepend(tmp_path)
    with caplog.at_level(logging.WARNING):
        assert OwnProcess(tmp_path / "nowhere")("only_here:work", ignore) == os.getpid()
    assert "cannot be started: " in caplog.text


def test_canceled_work_ends(tmp_path, monkeypatch):
    (tmp_path / "endless.py").write_text(
        "import time\n"
        "def work(path, progress):\n"
        "    while True:\n"
        "        progress('Waiting', 0.5)\n"
        "        open(path, 'a').close()\n"
        "        time.sleep(0.01)\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    before = threading.enumerate()

    def cancel(step, _share):
        if step:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        OwnProcess(PYTHON)("endless:work", cancel, str(tmp_path / "touched"))
    # The thread that looks after the end of the process ends with it.
    begun = [thread for thread in threading.enumerate() if thread not in before]
    for thread in begun:
        thread.join(120.0)
    assert not any(thread.is_alive() for thread in begun)


def test_showing_a_head_imports_no_scipy_and_finding_it_neither_slicer_nor_qt():
    program = (
        "import sys; sys.modules['slicer'] = sys.modules['qt'] = None\n"
        f"sys.path.insert(0, {str(LOGIC)!r})\n"
        "import rastrainer.slicer.head.volume\n"
        "import rastrainer.slicer.program.child_process\n"
        "assert 'scipy' not in sys.modules\n"
        "import rastrainer.slicer.head.head_draft"
    )
    subprocess.run([PYTHON, "-c", program], check=True)
