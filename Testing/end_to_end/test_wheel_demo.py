"""`rastrainer demo` of the wheel, in an empty folder: with Slicer's part, and without."""

import json
import os
import subprocess
import sys
from email.parser import HeaderParser

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


@pytest.fixture(scope="module")
def installed(built_wheel, tmp_path_factory):
    """A folder with the wheel alone; its requirements come from this Python."""
    folder = tmp_path_factory.mktemp("installed")
    words = ["--no-deps", "--no-index", "--no-cache-dir", "-q", "--target", str(folder)]
    command = [sys.executable, "-m", "pip", "install", *words, str(built_wheel)]
    subprocess.run(command, check=True)
    return folder


@pytest.fixture
def run(installed, tmp_path):
    """Returns a function that runs a command of this Python on the wheel, in an empty folder."""
    environment = {**os.environ, "PYTHONPATH": str(installed), "HOME": str(tmp_path / "home")}
    (tmp_path / "empty").mkdir()

    def run_command(*words):
        return subprocess.run(
            [sys.executable, *words],
            capture_output=True,
            text=True,
            cwd=tmp_path / "empty",
            env=environment,
        )

    return run_command


def test_the_demo_of_a_bare_wheel_says_in_one_sentence_what_to_install_and_does_nothing(
    run, tmp_path
):
    done = run("-c", WITHOUT_SLICER, "demo")
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr == (
        "rastrainer: The demo needs slicer-core, which plays the part of 3D Slicer: install it by "
        f'{sys.executable} -m pip install "rastrainer[slicer]"\n'
    )
    assert list((tmp_path / "empty").iterdir()) == []


def test_installing_what_the_demo_asks_for_provides_slicers_part(installed):
    (metadata,) = installed.glob("rastrainer-*.dist-info/METADATA")
    needs = HeaderParser().parsestr(metadata.read_text(encoding="utf-8")).get_all("Requires-Dist")
    assert {"slicer-core; extra == 'slicer'", "scipy"} <= set(needs)


@pytest.mark.soak
def test_the_demo_of_the_wheel_plays_both_trials_in_an_empty_folder(run, installed, tmp_path):
    where = run("-c", "import rastrainer, rastrainer_simulator as s; print(s.__file__)")
    assert where.stdout.startswith(str(installed))
    done = run("-m", "rastrainer_simulator.cli.main", "demo")
    assert done.returncode == 0, done.stderr
    output = tmp_path / "empty" / "rastrainer-demo"
    assert [name for name in NAMES if not (output / name).exists()] == []
    lines = (output / "results.jsonl").read_text(encoding="utf-8").splitlines()
    trials = [json.loads(line) for line in lines]
    assert [trial["record"]["task"] for trial in trials] == ["trial-run", "task-1"]
    command = ("-m", "rastrainer_simulator.cli.main")
    points = (str(output / name) for name in ("touches.csv", "fiducials.csv"))
    registered = run(*command, "register", *points, "--json")
    fre_mm = json.loads(registered.stdout)["fre_mm"]
    assert fre_mm == pytest.approx(trials[-1]["fits"]["rigid"]["freMm"])
    for name in ("report", "export"):
        done = run(*command, name, str(output / "study.db"), "-o", name)
        assert done.returncode == 0, done.stderr
    assert "virtual-01" in (tmp_path / "empty/export/csv/trials.csv").read_text(encoding="utf-8")
