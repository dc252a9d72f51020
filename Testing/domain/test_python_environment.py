"""The environment and the packages of a child process are free of Slicer's."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import rastrainer
from rastrainer.python_environment import LIBRARIES, clean_environment, private_command

LAUNCHED = {
    "APPLAUNCHER_LEVEL": "1",
    "SLICER_HOME": "/opt/Slicer/bin/..",
    "PATH": os.pathsep.join(["/opt/Slicer/bin", "/usr/bin", "/opt/Slicer/lib/Python/bin"]),
    "LD_LIBRARY_PATH": "/opt/Slicer/lib/Slicer-5.13",
    "PYTHONHOME": "/opt/Slicer/lib/Python",
    "QT_PLUGIN_PATH": "/opt/Slicer/lib/QtPlugins",
    "LANG": "C.UTF-8",
}


def test_variables_set_by_the_launcher_are_removed():
    assert clean_environment(LAUNCHED) == {"PATH": "/usr/bin", "LANG": "C.UTF-8"}


def test_variables_set_before_the_launcher_are_restored():
    saved = {"APPLAUNCHER_0_LD_LIBRARY_PATH": "/opt/driver", "APPLAUNCHER_0_PATH": "/mine:/usr/bin"}
    later = {"APPLAUNCHER_1_LD_LIBRARY_PATH": "/opt/Slicer/lib"}
    assert clean_environment({**LAUNCHED, **saved, **later}) == {
        "PATH": "/mine:/usr/bin",
        "LD_LIBRARY_PATH": "/opt/driver",
        "LANG": "C.UTF-8",
    }


LOOK = """
import os, sys, zlib
from rastrainer.python_environment import python_command
print(os.environ["LD_LIBRARY_PATH"])
print([line.split()[-1] for line in open("/proc/self/maps") if "libz.so" in line][-1])
print(python_command("other", "word"))
"""


@pytest.fixture
def private(tmp_path):
    """A private folder with a program that inspects its environment."""
    folder = tmp_path / "private"
    folder.mkdir()
    (folder / "look.py").write_text(LOOK)
    (folder / "rastrainer").symlink_to(Path(rastrainer.__file__).parent)
    return folder


@pytest.fixture
def libraries(tmp_path):
    """Two libraries of Slicer: Python needs only the first, by its versioned name."""
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
def test_only_libraries_needed_by_python_are_found(private, libraries):
    environment = {
        **os.environ,
        "APPLAUNCHER_LEVEL": "1",
        "LD_LIBRARY_PATH": str(libraries),
        "PYTHONHOME": sys.base_prefix,
    }
    words = private_command(Path(sys.executable), private, "look")
    for _again in range(2):
        done = subprocess.run(words, env=environment, capture_output=True, text=True, check=True)
        places, mapped, child = done.stdout.splitlines()
        assert places == str(private / LIBRARIES)
        assert mapped == str(libraries / "libz.so.1.9.9")
        links = {path.name: path.resolve() for path in (private / LIBRARIES).iterdir()}
        wanted = libraries / "libz.so.1.9.9"
        assert links == {"libz.so.1": wanted, "libz.so.1.9.9": wanted}
        assert child == str(private_command(Path(sys.executable), private, "other", "word"))
