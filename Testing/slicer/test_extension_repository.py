"""The tree that is registered: as Slicer's Extensions Index checks it, and small.

The rules come from the index's `scripts/check_description_files.py`, which clones the repository
with its whole history and allows 100 MB, and of its review, which reads every `.py` and `.md`.
"""

import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path
from urllib.parse import unquote

import pytest

ROOT = Path(__file__).parents[2]
NAMES = ("-c", "user.name=Release", "-c", "user.email=release@invalid")
sys.path.insert(0, str(ROOT / "tools"))
simulator_wheel = import_module("simulator_wheel")


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
    return sorted(path.relative_to(tree).as_posix() for path in tree.rglob("*") if path.is_file())


@pytest.fixture(scope="module")
def cmake(tree):
    return (tree / "CMakeLists.txt").read_text(encoding="utf-8")


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


def test_only_the_module_and_what_describes_it_are_in_the_tree(tree, files):
    names = "CMakeLists.txt LICENSE.txt LICENSES NOTICE.md RASTrainer README.md Screenshots"
    assert {name.partition("/")[0] for name in files} == set(names.split())
    ours = ROOT / "RASTrainer"
    modules = {path.relative_to(ROOT).as_posix() for path in ours.rglob("*.py")}
    assert {name for name in files if name.endswith(".py")} == modules
    for name in files:
        if name.endswith((".py", ".md", ".txt")):
            (tree / name).read_text(encoding="utf-8")


def test_cmake_names_the_extension_and_pictures_that_are_in_the_tree(cmake, files):
    assert re.search(r"project\s*\(\s*RASTrainer\)", cmake)
    for key in ("ICONURL", "SCREENSHOTURLS"):
        (addresses,) = re.findall(rf'set\s*\(EXTENSION_{key}\s*"([^"]+)"\s*\)', cmake)
        for address in addresses.split():
            base, _, name = address.partition("/SlicerRASTrainer/main/")
            assert base == "https://raw.githubusercontent.com/RASTrainer"
            assert name in files
    assert "LICENSE.txt" in files


def test_the_readme_says_what_the_index_asks_for_and_its_links_lead_somewhere(tree, files):
    readme = (tree / "README.md").read_text(encoding="utf-8")
    for heading in ("# RASTrainer", "## Module", "## Tutorial", "## Publication", "## License"):
        assert f"{heading}\n" in readme
    assert "Robot-Assisted Surgery Trainer" in readme
    assert "*Sample Data*" in readme
    links = re.findall(r"\]\(([^)]+)\)", readme)
    assert [unquote(link) for link in links if "://" not in link and link not in files] == []
    assert any(link.endswith(".jpg") for link in links)
    documents = re.findall(r"/RASTrainer/RASTrainer/(?:blob|tree)/main/([\w./-]+)", readme)
    assert documents
    assert all((ROOT / name).exists() for name in documents)
