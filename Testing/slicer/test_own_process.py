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
from rastrainer.slicer.head.head_draft import findSkin
from rastrainer.slicer.head.volume import Volume
from rastrainer.slicer.program.own_process import LOGIC, OwnProcess, runHere
from Testing.slicer.head.phantoms import phantom

FIND_SKIN = "rastrainer.slicer.head.head_draft:findSkin"
PYTHON = Path(sys.executable)
WHOSE = "import os\ndef work(progress):\n    return os.getpid()\n"


def ignore(_step, _share):
    pass


def test_the_head_is_the_one_that_is_made_here():
    scan = phantom(spacing=(3.0, 3.0, 3.0), size=0.75)
    told = []
    body, skin, warnings = OwnProcess(PYTHON)(
        FIND_SKIN, lambda *step: told.append(step), scan, None
    )
    expected, expected_skin, expected_warnings = findSkin(scan)
    assert body.baseMm == expected.baseMm
    np.testing.assert_array_equal(body.body, expected.body)
    np.testing.assert_array_equal(skin.vertices, expected_skin.vertices)
    assert warnings == expected_warnings
    assert told[-1] == ("Done", 1.0)


def test_what_cannot_be_used_is_refused_in_the_same_words():
    nothing = Volume(np.zeros((30, 30, 30), np.int16), np.eye(4))
    with pytest.raises(InputError) as here:
        findSkin(nothing)
    with pytest.raises(InputError) as there:
        OwnProcess(PYTHON)(FIND_SKIN, ignore, nothing, None)
    assert str(there.value) == str(here.value)


def test_a_process_that_ends_before_it_is_done_is_reported(tmp_path, monkeypatch):
    (tmp_path / "failing.py").write_text(
        "import os\ndef work(progress):\n    print('Out of paper.', flush=True)\n    os._exit(1)\n"
    )
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    with pytest.raises(InputError, match=r"ended before it was done: Out of paper\."):
        OwnProcess(PYTHON)("failing:work", ignore)


def test_the_work_is_done_by_another_process(tmp_path, monkeypatch):
    (tmp_path / "anywhere.py").write_text(WHOSE)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    assert OwnProcess(PYTHON)("anywhere:work", ignore) != os.getpid()
    monkeypatch.syspath_prepend(tmp_path)
    assert runHere("anywhere:work", ignore) == os.getpid()


def test_where_the_process_lacks_a_package_the_work_is_done_here(tmp_path, monkeypatch, caplog):
    (tmp_path / "only_here.py").write_text(WHOSE)
    monkeypatch.syspath_prepend(tmp_path)
    with caplog.at_level(logging.WARNING):
        assert OwnProcess(PYTHON)("only_here:work", ignore) == os.getpid()
    assert "lacks only_here: only_here:work runs in Slicer." in caplog.text


def test_where_no_process_can_be_started_the_work_is_done_here(tmp_path, monkeypatch, caplog):
    (tmp_path / "only_here.py").write_text(WHOSE)
    monkeypatch.syspath_prepend(tmp_path)
    with caplog.at_level(logging.WARNING):
        assert OwnProcess(tmp_path / "nowhere")("only_here:work", ignore) == os.getpid()
    assert "cannot be started: " in caplog.text


def test_what_is_canceled_ends(tmp_path, monkeypatch):
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
        "import rastrainer.slicer.head.segment, rastrainer.slicer.head.head_body\n"
        "import rastrainer.slicer.head.scenario_build, rastrainer.slicer.program.own_process\n"
        "assert 'scipy' not in sys.modules\n"
        "import rastrainer.slicer.head.head_draft"
    )
    subprocess.run([PYTHON, "-c", program], check=True)
