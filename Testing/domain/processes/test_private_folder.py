"""What runs on the packages of a folder has Python's own libraries, and no others of Slicer's."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import rastrainer
from rastrainer.processes.private_folder import LIBRARIES, private_words, python_words

LOOK = """
import os, sys, zlib
from rastrainer.processes.private_folder import python_words
print(os.environ["LD_LIBRARY_PATH"])
print([line.split()[-1] for line in open("/proc/self/maps") if "libz.so" in line][-1])
print(python_words("other", "word"))
"""


def test_without_a_private_folder_a_module_is_started_by_this_python():
    assert python_words("module", "word") == [sys.executable, "-m", "module", "word"]


@pytest.fixture
def private(tmp_path):
    """A private folder with a program that looks around."""
    folder = tmp_path / "private"
    folder.mkdir()
    (folder / "look.py").write_text(LOOK)
    (folder / "rastrainer").symlink_to(Path(rastrainer.__file__).parent)
    return folder


@pytest.fixture
def libraries(tmp_path):
    """Slicer's libraries: one that Python needs, under the name of its version, and another."""
    system = sorted(Path("/usr/lib").glob("*/libz.so.1"))
    if not system:
        pytest.skip("Python has its own compression here")
    folder = tmp_path / "lib"
    folder.mkdir()
    shutil.copyfile(system[0], folder / "libz.so.1.9.9")
    (folder / "libz.so.1").symlink_to("libz.so.1.9.9")
    shutil.copyfile(system[0], folder / "libother.so.1")
    return folder


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="of the loader of Linux")
def test_of_slicers_libraries_only_those_that_its_python_needs_are_found(private, libraries):
    environment = {
        **os.environ,
        "APPLAUNCHER_LEVEL": "1",
        "LD_LIBRARY_PATH": str(libraries),
        "PYTHONHOME": sys.base_prefix,
    }
    words = private_words(Path(sys.executable), private, "look")
    for _again in range(2):
        done = subprocess.run(words, env=environment, capture_output=True, text=True, check=True)
        places, mapped, child = done.stdout.splitlines()
        assert places == str(private / LIBRARIES)
        assert mapped == str(libraries / "libz.so.1.9.9")
        links = {path.name: path.resolve() for path in (private / LIBRARIES).iterdir()}
        wanted = libraries / "libz.so.1.9.9"
        assert links == {"libz.so.1": wanted, "libz.so.1.9.9": wanted}
        assert child == str(private_words(Path(sys.executable), private, "other", "word"))
