"""`rastrainer demo` of the wheel, in an empty folder: with Slicer's part, and without."""

import json
import os
import subprocess
import sys

import pytest

NAMES = (
    "robot.png",
    "residuals.png",
    "procedure.png",
    "trial.mrb",
    "study.db",
    "touches.csv",
    "fiducials.csv",
    "records",
    "results.jsonl",
)
WITHOUT_SLICER = """
import sys
sys.modules["slicer"] = None
from rastrainer_simulator.cli.main import main
sys.exit(main())
"""
"""Starts `rastrainer` where nothing of that name can be imported."""


def run(folder, words, **variables):
    """Run a command of this Python in a new, empty folder."""
    (folder / "empty").mkdir(exist_ok=True)
    environment = {**os.environ, "HOME": str(folder / "home"), **variables}
    command = [sys.executable, *words]
    place = {"cwd": folder / "empty", "env": environment}
    return subprocess.run(command, capture_output=True, text=True, **place)


def test_the_demo_without_slicers_part_says_in_one_sentence_what_to_install_and_does_nothing(
    tmp_path,
):
    done = run(tmp_path, ("-c", WITHOUT_SLICER, "demo"))
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == (
        "rastrainer: The demo needs slicer-core, which plays the part of 3D Slicer: install it by "
        f'{sys.executable} -m pip install "rastrainer[slicer]"\n'
    )
    assert list((tmp_path / "empty").iterdir()) == []


@pytest.mark.soak
def test_the_demo_of_the_wheel_plays_both_trials_in_an_empty_folder(built_wheel, tmp_path):
    # The wheel alone; its requirements come from this Python.
    installed = str(tmp_path / "installed")
    words = ["--no-deps", "--no-index", "--no-cache-dir", "-q", "--target", installed]
    command = [sys.executable, "-m", "pip", "install", *words, str(built_wheel)]
    subprocess.run(command, check=True)

    def rastrainer(*words):
        return run(tmp_path, ("-m", "rastrainer_simulator.cli.main", *words), PYTHONPATH=installed)

    where = ("-c", "import rastrainer_simulator as simulator; print(simulator.__file__)")
    assert run(tmp_path, where, PYTHONPATH=installed).stdout.startswith(installed)
    done = rastrainer("demo")
    assert done.returncode == 0, done.stderr
    output = tmp_path / "empty" / "rastrainer-demo"
    assert [name for name in NAMES if not (output / name).exists()] == []
    lines = (output / "results.jsonl").read_text(encoding="utf-8").splitlines()
    trials = [json.loads(line) for line in lines]
    assert [trial["record"]["task"] for trial in trials] == ["trial-run", "task-1"]
    points = (str(output / name) for name in ("touches.csv", "fiducials.csv"))
    registered = rastrainer("register", *points, "--json")
    fre_mm = json.loads(registered.stdout)["fre_mm"]
    assert fre_mm == pytest.approx(trials[-1]["fits"]["rigid"]["freMm"])
    for name in ("report", "export"):
        done = rastrainer(name, str(output / "study.db"), "-o", name)
        assert done.returncode == 0, done.stderr
    assert "virtual-01" in (tmp_path / "empty/export/csv/trials.csv").read_text(encoding="utf-8")
