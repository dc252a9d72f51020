"""What CMake installs, by the extension's own lists: complete, and it opens."""

import json
import os
import shutil
import subprocess
import sys
import zipfile
from importlib import import_module
from pathlib import Path

import pytest

from rastrainer.slicer.program.simulator_package import WHEEL, SimulatorPackage

ROOT = Path(__file__).parents[2]
STUB = Path(__file__).parent / "cmake"
MODULES = Path("lib", "Slicer-5.13", "qt-scripted-modules")
ASSETS = ("robots/iiwa7", "scenarios/colin27", "studies")
sys.path.insert(0, str(ROOT / "tools"))
simulator_wheel = import_module("simulator_wheel")

LARGER_APPLICATION = """
cmake_minimum_required(VERSION 3.20)
project(LargerApplication)
add_subdirectory("{source}" extension)
"""


@pytest.fixture(scope="module")
def clone(built_wheel, tmp_path_factory):
    """The tree that Slicer's Extensions Index registers, which tests only read."""
    folder = tmp_path_factory.mktemp("registered") / "clone"
    simulator_wheel.write_tree(built_wheel, folder)
    return folder


@pytest.fixture
def repository(clone, tmp_path):
    """A copy of it, to be changed."""
    return shutil.copytree(clone, tmp_path / "clone")


def configure(source, build, *options):
    """Run CMake and return its status and output."""
    command = ["cmake", "-S", str(source), "-B", str(build), f"-DSlicer_DIR={STUB}", *options]
    done = subprocess.run(command, capture_output=True, text=True)
    return done.returncode, " ".join(f"{done.stdout}\n{done.stderr}".split())


def install(build, tree):
    command = ["cmake", "--install", str(build), "--prefix", str(tree)]
    subprocess.run(command, check=True, capture_output=True)
    return tree / MODULES


@pytest.fixture(scope="module")
def tree(clone, tmp_path_factory):
    """The folder of modules in an installed tree, which tests only read."""
    folder = tmp_path_factory.mktemp("installed")
    status, said = configure(clone, folder / "build")
    assert status == 0, said
    return install(folder / "build", folder / "tree")


def relative(folder, pattern="*"):
    return sorted(
        path.relative_to(folder).as_posix() for path in folder.rglob(pattern) if path.is_file()
    )


def test_a_wheel_that_is_missing_or_another_than_was_built_is_refused(repository, tmp_path):
    wheel = repository / "RASTrainer" / "Resources" / "RASTrainerSimulator" / WHEEL
    wheel.write_bytes(wheel.read_bytes() + b"more")
    status, said = configure(repository, tmp_path / "build")
    assert status != 0
    assert f"is not the file that {WHEEL}.sha256 notes" in said
    wheel.unlink()
    status, said = configure(repository, tmp_path / "build")
    assert status != 0
    assert f"The simulator's wheel {WHEEL} is missing. Build it, in {repository}, by:" in said


def test_the_installed_tree_holds_assets_simulator_and_licenses(tree):
    installed = tree / "Resources" / "RASTrainer"
    for part in ASSETS:
        assert relative(installed / part) == relative(ROOT / "assets" / part)
    for name in ("LICENSE.txt", "NOTICE.md"):
        assert (installed / name).read_bytes() == (ROOT / name).read_bytes()
    package = SimulatorPackage.of(tree)
    assert package.checkout is None
    assert f"/{WHEEL} \\\n    --hash=sha256:{package.digest()}\n" in package.requirements()
    with zipfile.ZipFile(package.folder / WHEEL) as wheel:
        packed = wheel.read("rastrainer_simulator/assets/scenarios/colin27/volume.nrrd")
    assert packed == (ROOT / "assets/scenarios/colin27/volume.nrrd").read_bytes()


def test_as_part_of_a_larger_application_everything_lies_beside_the_module(repository, tmp_path):
    larger = tmp_path / "larger"
    larger.mkdir()
    text = LARGER_APPLICATION.format(source=repository)
    (larger / "CMakeLists.txt").write_text(text, encoding="utf-8")
    status, said = configure(larger, tmp_path / "build")
    assert status == 0, said
    for modules in (tmp_path / "build" / MODULES, install(tmp_path / "build", tmp_path / "tree")):
        assert (modules / "RASTrainer.py").is_file()
        resources = modules / "Resources"
        assert (resources / "RASTrainer" / "scenarios" / "colin27" / "scenario.json").is_file()
        assert (resources / "RASTrainerSimulator" / WHEEL).is_file()


def test_the_module_opens_from_the_installed_tree(tree, tmp_path):
    command = [sys.executable, "-m", "Testing.slicer.installed_module", str(tree / "RASTrainer.py")]
    environment = {**os.environ, "PYTHONPATH": str(tree / "Logic"), "QT_QPA_PLATFORM": "offscreen"}
    done = subprocess.run(
        [*command, str(tmp_path / "slicer")],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env=environment,
    )
    assert done.returncode == 0, done.stderr
    seen = json.loads(done.stdout.splitlines()[-1])
    assert seen["package"] == str(tree / "Logic" / "rastrainer")
    assert (seen["checkout"], seen["tasks"] > 1, seen["errors"]) == (False, True, [])
    assert "press Set up, once" in seen["setup"]
    assert seen["requirements"] > 100
