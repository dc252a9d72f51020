"""The tree that is registered, as Slicer's Extensions Index checks it, and what CMake installs.

The rules come from the index's `scripts/check_description_files.py`, which clones the repository
with its whole history and allows 100 MB, and of its review, which reads every `.py` and `.md`.
"""

import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from importlib import import_module
from pathlib import Path
from urllib.parse import unquote

import pytest

from rastrainer.slicer.program.simulator_package import WHEEL, SimulatorPackage

ROOT = Path(__file__).parents[2]
NAMES = ("-c", "user.name=Release", "-c", "user.email=release@invalid")
sys.path.insert(0, str(ROOT / "tools"))
simulator_wheel = import_module("simulator_wheel")
STUB = Path(__file__).parent / "cmake"
MODULES = Path("lib", "Slicer-5.13", "qt-scripted-modules")
LARGER_APPLICATION = """
cmake_minimum_required(VERSION 3.20)
project(LargerApplication)
add_subdirectory("{source}" extension)
"""


def size_mb(folder):
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) / 1e6


@pytest.fixture(scope="module")
def tree(built_wheel, tmp_path_factory):
    """The tree, which tests only read."""
    folder = tmp_path_factory.mktemp("registered") / "tree"
    simulator_wheel.write_tree(built_wheel, folder)
    return folder


@pytest.fixture(scope="module")
def files(tree):
    return relative(tree)


def relative(folder):
    return sorted(
        path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()
    )


def test_tree_and_clone_are_far_below_the_limit_of_the_index(tree, files, tmp_path):
    assert len(files) <= 300
    assert size_mb(tree) <= 15
    origin, clone = tmp_path / "origin", tmp_path / "clone"
    git = ["git", *NAMES, f"--git-dir={origin}", f"--work-tree={tree}"]
    subprocess.run([*git[:5], "init", "-q", "--bare", "-b", "main", str(origin)], check=True)
    for words in (["add", "--all"], ["commit", "-q", "-m", "Release"]):
        subprocess.run([*git, *words], check=True)
    subprocess.run(["git", "clone", "-q", origin.as_uri(), str(clone)], check=True)
    assert size_mb(clone) <= 30


def test_only_the_module_and_what_describes_it_are_in_the_tree(files):
    names = "CMakeLists.txt LICENSE.txt LICENSES NOTICE.md RASTrainer README.md Screenshots"
    assert {name.partition("/")[0] for name in files} == set(names.split())
    ours = ROOT / "RASTrainer"
    modules = {path.relative_to(ROOT).as_posix() for path in ours.rglob("*.py")}
    assert {name for name in files if name.endswith(".py")} == modules


def test_cmake_names_pictures_that_are_in_the_tree(tree, files):
    cmake = (tree / "CMakeLists.txt").read_text(encoding="utf-8")
    for key in ("ICONURL", "SCREENSHOTURLS"):
        (addresses,) = re.findall(rf'set\s*\(EXTENSION_{key}\s*"([^"]+)"\s*\)', cmake)
        for address in addresses.split():
            base, _, name = address.partition("/SlicerRASTrainer/main/")
            assert base == "https://raw.githubusercontent.com/RASTrainer"
            assert name in files


def test_the_readme_says_what_the_index_asks_for_and_its_links_lead_somewhere(tree, files):
    readme = (tree / "README.md").read_text(encoding="utf-8")
    for heading in ("# RASTrainer", "## Module", "## Tutorial", "## Publication", "## License"):
        assert f"{heading}\n" in readme
    links = re.findall(r"\]\(([^)]+)\)", readme)
    assert [unquote(link) for link in links if "://" not in link and link not in files] == []
    documents = re.findall(r"/RASTrainer/RASTrainer/(?:blob|tree)/main/([\w./-]+)", readme)
    assert documents != [] == [name for name in documents if not (ROOT / name).exists()]


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
def installed(tree, tmp_path_factory):
    """The folder of modules in an installed tree, which tests only read."""
    folder = tmp_path_factory.mktemp("installed")
    status, said = configure(tree, folder / "build")
    assert status == 0, said
    return install(folder / "build", folder / "tree")


def test_a_wheel_that_is_missing_or_another_than_was_built_is_refused(tree, tmp_path):
    repository = shutil.copytree(tree, tmp_path / "clone")
    wheel = repository / "RASTrainer" / "Resources" / "RASTrainerSimulator" / WHEEL
    wheel.write_bytes(wheel.read_bytes() + b"more")
    status, said = configure(repository, tmp_path / "build")
    assert status != 0
    assert f"is not the file that {WHEEL}.sha256 notes" in said
    wheel.unlink()
    status, said = configure(repository, tmp_path / "build")
    assert status != 0
    assert f"The simulator's wheel {WHEEL} is missing. Build it, in {repository}, by:" in said


def test_the_installed_tree_holds_assets_simulator_and_licenses(installed):
    resources = installed / "Resources" / "RASTrainer"
    for part in ("robots/iiwa7", "scenarios/colin27", "studies"):
        assert relative(resources / part) == relative(ROOT / "assets" / part)
    for name in ("LICENSE.txt", "NOTICE.md"):
        assert (resources / name).read_bytes() == (ROOT / name).read_bytes()
    package = SimulatorPackage.of(installed)
    assert package.checkout is None
    assert f"/{WHEEL} \\\n    --hash=sha256:{package.digest()}\n" in package.requirements()
    with zipfile.ZipFile(package.folder / WHEEL) as wheel:
        packed = wheel.read("rastrainer_simulator/assets/scenarios/colin27/volume.nrrd")
    assert packed == (ROOT / "assets/scenarios/colin27/volume.nrrd").read_bytes()


def test_as_part_of_a_larger_application_everything_lies_beside_the_module(tree, tmp_path):
    larger = tmp_path / "larger"
    larger.mkdir()
    text = LARGER_APPLICATION.format(source=tree)
    (larger / "CMakeLists.txt").write_text(text, encoding="utf-8")
    status, said = configure(larger, tmp_path / "build")
    assert status == 0, said
    for modules in (tmp_path / "build" / MODULES, install(tmp_path / "build", tmp_path / "tree")):
        assert (modules / "RASTrainer.py").is_file()
        resources = modules / "Resources"
        assert (resources / "RASTrainer" / "scenarios" / "colin27" / "scenario.json").is_file()
        assert (resources / "RASTrainerSimulator" / WHEEL).is_file()


def test_the_module_opens_from_the_installed_tree(installed, tmp_path):
    module, home = str(installed / "RASTrainer.py"), str(tmp_path / "slicer")
    places = {"PYTHONPATH": str(installed / "Logic"), "QT_QPA_PLATFORM": "offscreen"}
    done = subprocess.run(
        [sys.executable, "-m", "Testing.slicer.installed_module", module, home],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env={**os.environ, **places},
    )
    assert done.returncode == 0, done.stderr
    seen = json.loads(done.stdout.splitlines()[-1])
    assert seen["package"] == str(installed / "Logic" / "rastrainer")
    assert (seen["checkout"], seen["tasks"] > 1, seen["errors"]) == (False, True, [])
    assert "press Set up, once" in seen["setup"]
    assert seen["requirements"] > 100
