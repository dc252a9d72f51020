"""PythonSlicer as it is in a release of Slicer: a launcher with the real Python as its child.

It behaves as CTK's launcher, which Slicer renames: it saves the environment that it was started in
under `APPLAUNCHER_<level>_…`, puts Slicer's folders first in its lists, starts the real Python as
a child, passes no signal on, and reports a child that a signal has ended as status 1. Killing
the launcher leaves the real Python alone.

Its packages are Slicer's. The tests' packages are in the same environment, so that they can be
imported, too; the simulator's packages are only in the private folder of a set-up.
"""

from __future__ import annotations

import os
import shutil
import sys
from pathlib import Path

LIBRARIES = Path("lib", "Slicer-5.13")
"""Folder of Slicer's libraries, below its own; the launcher puts it into LD_LIBRARY_PATH."""
PACKAGES = Path("lib", "Python", "lib", "site-packages")
"""Folder of packages in Slicer's Python, below Slicer's own; in PYTHONPATH."""
LENT_LIBRARIES = ("libstdc++.so.6", "libgcc_s.so.1")
"""A library of this computer. A copy lies in Slicer's folder: a test sees which one is loaded."""

NOT_SLICERS = ("rastrainer_simulator", "rastrainer_headless")
"""Packages of the simulator. A private folder is searched without `site`, and so without this."""

SITE_CUSTOMIZE = f"""
import sys


class OnlyInPrivateFolders:
    @staticmethod
    def find_spec(name, path=None, target=None):
        if name.partition(".")[0] in {NOT_SLICERS!r}:
            raise ModuleNotFoundError(f"Slicer's Python has no package {{name}}.", name=name)


sys.meta_path.insert(0, OnlyInPrivateFolders)
"""

LAUNCHER = """#!{python} -IS
import os
import subprocess
import sys

HOME = {home!r}
before = dict(os.environ)
level = int(before.get("APPLAUNCHER_LEVEL", 0))
environment = dict(before)
for name, value in before.items():
    if not name.startswith("APPLAUNCHER_"):
        environment["APPLAUNCHER_%d_%s" % (level, name)] = value
environment["APPLAUNCHER_LEVEL"] = str(level + 1)
environment.update(
    SLICER_HOME=HOME,
    PYTHONHOME={prefix!r},
    PYTHONNOUSERSITE="1",
    ITK_AUTOLOAD_PATH=HOME + "/lib/ITKFactories",
)
for name, folder in (
    ("LD_LIBRARY_PATH", {libraries!r}),
    ("LibraryPaths", {libraries!r}),
    ("PYTHONPATH", {packages!r}),
    ("QT_PLUGIN_PATH", HOME + "/lib/QtPlugins"),
    ("PATH", HOME + "/bin"),
):
    environment[name] = os.pathsep.join(filter(None, (folder, before.get(name))))
status = subprocess.call([{python!r}, *sys.argv[1:]], env=environment)
if status < 0:
    print("error: [%s] exit abnormally - Report the problem." % {python!r}, file=sys.stderr)
sys.exit(status if status >= 0 else 1)
"""


def write_python_slicer(home: Path) -> Path:
    """Put the launcher where Slicer has it, in the folder `home`, and return its path.

    The real Python runs the tests. Slicer has two packages: the first names its owner, the second
    hides the simulator's.
    """
    program = home / "bin" / "PythonSlicer"
    if os.name == "nt" or program.exists():
        return program
    for folder in (program.parent, home / LIBRARIES, home / PACKAGES):
        folder.mkdir(parents=True)
    (home / PACKAGES / "slicers_own_package.py").write_text("", encoding="utf-8")
    (home / PACKAGES / "sitecustomize.py").write_text(SITE_CUSTOMIZE, encoding="utf-8")
    for name in LENT_LIBRARIES:
        for found in sorted(Path("/usr/lib").glob(f"*/{name}")):
            shutil.copyfile(found, home / LIBRARIES / name)
    program.write_text(
        LAUNCHER.format(
            python=sys.executable,
            home=str(home),
            prefix=sys.base_prefix,
            libraries=str(home / LIBRARIES),
            packages=str(home / PACKAGES),
        ),
        encoding="utf-8",
    )
    program.chmod(0o755)
    return program
