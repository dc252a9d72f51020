"""What Slicer has to import at its start, and when the module is opened."""

import json
import os
import subprocess
import sys
from itertools import pairwise

import pytest

PROGRAM = """
import builtins, json, sys, tempfile
from pathlib import Path
from Testing.slicer.host.host import MODULE_FILE, Host
from Testing.slicer.host.values import Slot

imported, original = [], builtins.__import__


def record(name, globals=None, locals=None, fromlist=(), level=0):
    frame, importer = sys._getframe(1), (globals or {}).get("__name__", "")
    if importer.split(".")[0] in ("rastrainer", MODULE_FILE.stem):
        names = [name, *(f"{name}.{each}" for each in fromlist or ())]
        imported.append((importer, names, frame.f_code.co_name == "<module>"))
    return original(name, globals, locals, fromlist, level)


def ours():
    return sorted(name for name in sys.modules if name.split(".")[0] == "rastrainer")


# The host itself has imported what it needs of our package.
for name in ours():
    del sys.modules[name]
builtins.__import__ = record
host = Host(Path(tempfile.mkdtemp()) / "slicer")
counts = []
try:
    started = ours()
    at_start = imported[:]
    Slot.watchers.append(lambda: counts.append(len(ours())))
    host.open()
    errors = host.errors[:]
finally:
    host.close()
print(json.dumps({"at_start": at_start, "started": started, "imported": imported,
                  "opened": ours(), "errors": errors, "counts": counts}))
"""
HEAVY = ("numpy", "scipy", "vtk", "vtkmodules")
LAZY = ("scipy", "vtk")
"""Alone, these import next to nothing: their parts come with the first use."""
ONLY_WHEN_NEEDED = ("head.head_draft", "slicer.head", "study.study_data")
"""Below `rastrainer`: what a button needs that most users never press, or a separate process. Here
scipy may be imported, and VTK's."""


@pytest.fixture(scope="module")
def found():
    """Imports in a new interpreter: importer, names, and whether at file scope."""
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen"}
    ended = subprocess.run(
        [sys.executable, "-c", PROGRAM], env=environment, capture_output=True, text=True
    )
    assert ended.returncode == 0, ended.stderr
    found = json.loads(ended.stdout.splitlines()[-1])
    assert found["errors"] == []
    return found


def heavy(imported, *packages):
    """Return who imports parts of these packages at file scope, with the parts."""
    return sorted(
        {
            (importer, name)
            for importer, names, is_at_file_scope in imported
            for name in names[:1]
            if is_at_file_scope and name.split(".")[0] in packages and name not in LAZY
        }
    )


def test_the_start_of_slicer_imports_no_library_and_hardly_anything_of_ours(found):
    assert [name for name in found["started"] if name.count(".") > 1 or "sections" in name] == [
        "rastrainer.sections",
        "rastrainer.sections.sample_data",
    ]
    assert heavy(found["at_start"], *HEAVY) == []
    assert any(importer == "RASTrainer" for importer, *_more in found["at_start"])


def test_opening_the_module_imports_no_library_and_nothing_that_only_a_button_or_process_needs(
    found,
):
    assert heavy(found["imported"], "scipy", "vtk", "vtkmodules") == []
    assert len(found["opened"]) > 100
    prefixes = tuple(f"rastrainer.{each}" for each in ONLY_WHEN_NEEDED)
    assert [name for name in found["opened"] if name.startswith(prefixes)] == []


def test_the_module_opens_in_turns_of_few_imports_each(found):
    counts = [len(found["started"]), *found["counts"]]
    assert counts[-1] == len(found["opened"])
    # A module comes with its packages, and with its imports within functions.
    assert max(after - before for before, after in pairwise(counts)) <= 6
