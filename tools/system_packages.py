"""Install the system packages that a make target needs, or say in one sentence which are missing.

Debian and Ubuntu only: elsewhere what is missing is named. Nothing is installed that is there.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import sys
from pathlib import Path

EGL = ("libEGL.so.1", ["libegl1", "libegl-mesa0", "libgl1", "libgl1-mesa-dri"])
LIBRARIES = {
    "demo": [EGL, ("libGL.so.1", ["libgl1"]), ("libXrender.so.1", ["libxrender1"])],
    "test": [EGL, ("libGL.so.1", ["libgl1"]), ("libXrender.so.1", ["libxrender1"])],
}
PROGRAMS = {"demo": [], "test": [("g++", ["g++"])]}
FILES = {
    "demo": [],
    "test": [("/usr/include/igtl/igtlMessageHeader.h", ["libopenigtlink-dev"])],
}


def missing_packages(target: str) -> list[str]:
    """Return the Debian packages that `target` needs and that are not there, in order."""
    wanted: list[str] = []
    for library, packages in LIBRARIES[target]:
        if not _loads(library):
            wanted += packages
    for program, packages in PROGRAMS[target]:
        if shutil.which(program) is None:
            wanted += packages
    for file, packages in FILES[target]:
        if not Path(file).exists():
            wanted += packages
    return list(dict.fromkeys(wanted))


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def main() -> int:
    """Install what the target named on the command line misses; 0 where all is there."""
    if not sys.platform.startswith("linux"):
        return 0
    wanted = missing_packages(sys.argv[1])
    if not wanted:
        return 0
    command = ["apt-get", "install", "-y", "--no-install-recommends", *wanted]
    if os.geteuid() != 0 or shutil.which("apt-get") is None:
        print(f"System packages are missing; install them with: sudo {' '.join(command)}")
        return 1
    subprocess.run(["apt-get", "update", "-qq"], check=True)
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    subprocess.run(command, check=True, env=environment, stdout=subprocess.DEVNULL)
    return 0


if __name__ == "__main__":
    sys.exit(main())
