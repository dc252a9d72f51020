"""The packages that a set-up from Slicer keeps are enough for trials and planning."""

import json
import os
import re
import shutil
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import pytest

from rastrainer.igtl.client import Client
from rastrainer.protocol import DEFAULT_HOST
from rastrainer.python_environment import private_command
from rastrainer.scenario.scenario import load_scenario
from rastrainer.slicer.program.simulator_package import LOCK, SimulatorPackage
from rastrainer.slicer.program.trim_packages import SIZES
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.virtual.scripted_trial import play_trial, send_hello
from Testing.end_to_end.simulator_process import ViewedSimulator

pytestmark = [
    pytest.mark.soak,
    pytest.mark.skipif(not Path("/proc/self/maps").exists(), reason="Linux tells"),
]
ROOT = Path(__file__).parents[2]
SIMULATOR, TRIMMER = "rastrainer_simulator.cli.main", "rastrainer.slicer.program.trim_packages"
NEVER_IMPORTED = ("embreex", "networkx", "Cython", "scipy/stats/tests")


def fill(folder: Path, wheel: Path) -> None:
    """Put the wheel and what the simulator's lock names into a folder, as pip would.

    Files of this Python's packages are linked, not copied; removing one removes the link.
    """
    words = ["--no-deps", "--no-index", "--no-cache-dir", "-q", "--target", str(folder)]
    subprocess.run([sys.executable, "-m", "pip", "install", *words, str(wheel)], check=True)
    lock = SimulatorPackage.of(ROOT / "RASTrainer").folder / LOCK
    for name in set(re.findall(r"^([a-z0-9._-]+)==", lock.read_text("utf-8"), re.MULTILINE)):
        try:
            found = distribution(name)
        except PackageNotFoundError:
            continue  # For another platform or version of Python.
        root = Path(found.locate_file(""))
        for file in found.files:
            source = Path(found.locate_file(file)).resolve()
            if source.is_file() and source.is_relative_to(root):
                _link(source, folder / source.relative_to(root))


def trim(folder: Path) -> tuple[dict[str, int], str]:
    """Trim a folder as a set-up does; return the sizes that it notes, and its output."""
    done = run(folder, str(folder), program=TRIMMER)
    assert done.returncode == 0, done.stderr
    return json.loads((folder / SIZES).read_text(encoding="utf-8")), done.stdout


def run(folder: Path, *words: str, program: str = SIMULATOR) -> subprocess.CompletedProcess[str]:
    """Run a program, as a rule `rastrainer`, on the packages of the folder alone."""
    command = private_command(Path(sys.executable), folder, program, *words)
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    return subprocess.run(command, capture_output=True, text=True, env=environment)


def _link(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    if target.exists():
        return
    try:
        os.link(source, target)
    except OSError:
        shutil.copy(source, target)  # On another disk.


@pytest.fixture(scope="module")
def trimmed(built_wheel, tmp_path_factory):
    """A filled and trimmed folder, the sizes that were noted, and the output."""
    folder = tmp_path_factory.mktemp("private") / "simulator"
    fill(folder, built_wheel)
    return folder, *trim(folder)


def test_unused_files_are_removed_and_the_rest_fits_in_700_mb(trimmed):
    folder, sizes, said = trimmed
    assert "that are never opened were removed" in said
    assert sizes["removedBytes"] > 400e6
    assert sizes["keptBytes"] < 700e6
    assert [name for name in NEVER_IMPORTED if (folder / name).exists()] == []
    assert not (folder / "cmeel.prefix" / "include").exists()
    assert not list(folder.rglob("*.a"))


def test_trials_checks_and_reports_work_with_the_trimmed_packages(trimmed, tmp_path):
    folder = trimmed[0]

    class TrimmedSimulator(ViewedSimulator):
        command = tuple(private_command(Path(sys.executable), folder, SIMULATOR, "simulator"))

    done = run(folder, "doctor")
    assert "Packages that can be loaded: aiohttp" in done.stdout
    assert "cannot be loaded" not in done.stdout
    assert f"page for browsers and headsets is in {folder}" in done.stdout
    colin = asset_path("scenarios", "colin27")
    arguments = ("--speed", "20", "--view-port", "0", "--log-folder", str(tmp_path / "logs"))
    with (
        TrimmedSimulator(tmp_path / "records", *arguments) as simulator,
        Client(DEFAULT_HOST, simulator.port) as client,
    ):
        send_hello(client, "scripted trainee")
        trial = play_trial(client, load_scenario(colin), "trial-run", "trainee-01", 7)
    assert trial.last_state["nextPoint"] is None
    done = run(folder, "scenario", "check", str(colin))
    assert done.returncode == 0, done.stdout + done.stderr
    study = asset_path("studies", "published.csv")
    done = run(folder, "report", str(study), "-o", str(tmp_path))
    assert done.returncode == 0, done.stdout + done.stderr
    assert (tmp_path / "report.html").read_text(encoding="utf-8").count("<svg") > 10
