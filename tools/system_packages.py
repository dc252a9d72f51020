"""Install the system packages that a make target needs, or name the missing packages.

Only Linux needs any: the wheels for Windows and macOS are complete. On a
system other than Debian, or without root, the missing packages are only named.
"""

import ctypes
import os
import shutil
import subprocess
import sys
from pathlib import Path

RENDER_ONE_PICTURE = """
import vtk
window = vtk.vtkRenderWindow()
window.SetOffScreenRendering(1)
window.AddRenderer(vtk.vtkRenderer())
window.Render()
"""
OPEN_QT = """
from PySide6.QtWidgets import QApplication
QApplication([])
"""
FIND_BROWSER = """
from rastrainer_simulator.ops.application_window import application_browser
raise SystemExit(application_browser() is None)
"""
FIND_CHINESE_FONT = """
import subprocess
found = subprocess.run(["fc-list", ":lang=zh-cn"], capture_output=True, check=True)
raise SystemExit(found.stdout == b"")
"""
WAIT = ("-o", "DPkg::Lock::Timeout=300")
"""For another installation to end, s: many machines look for updates when they start."""

EVERY, TESTS, SOAK = ("demo", "simulator", "test", "soak"), ("test", "soak"), ("soak",)
QT_LIBRARIES = ["libegl1", "libgl1", "libfontconfig1", "libxkbcommon0", "libdbus-1-3"]
MRI = Path("/usr/share/mricron/templates/ch2.nii.gz")
CT = Path("/usr/share/doc/invesalius-examples/examples/Cranium.inv3")
NEEDED = (
    (EVERY, lambda: _loads("libgomp.so.1"), ["libgomp1"]),
    (EVERY, lambda: _runs(RENDER_ONE_PICTURE), ["libegl1", "libgl1-mesa-dri", "libxcursor1"]),
    (EVERY[1:], lambda: _loads("libGLX.so.0"), ["libgl1", "libglx-mesa0"]),
    (["simulator"], lambda: not os.environ.get("DISPLAY") or _runs(FIND_BROWSER), ["chromium"]),
    (TESTS, lambda: shutil.which("g++"), ["g++", "libc6-dev"]),
    (TESTS, lambda: shutil.which("cmake"), ["cmake"]),
    (TESTS, Path("/usr/include/openigtlink/igtlMessageHeader.h").exists, ["libopenigtlink-dev"]),
    (TESTS, lambda: shutil.which("Xvfb"), ["xvfb"]),
    (TESTS, lambda: shutil.which("chromium"), ["chromium"]),
    (TESTS, Path("/usr/share/fonts/truetype").is_dir, ["fonts-dejavu-core"]),
    (TESTS, lambda: _runs(FIND_CHINESE_FONT), ["fontconfig", "fonts-wqy-microhei"]),
    (TESTS, lambda: _runs(OPEN_QT, QT_QPA_PLATFORM="offscreen"), QT_LIBRARIES),
    # An MRI and a CT, only for tests; `make soak` makes scenarios of them.
    (SOAK, MRI.exists, ["mricron-data"]),
    (SOAK, CT.exists, ["invesalius-examples"]),
    (SOAK, lambda: any(Path("/usr/lib/postgresql").glob("*/bin/initdb")), ["postgresql"]),
    (SOAK, lambda: _loads("libusb-1.0.so.0"), ["libusb-1.0-0"]),  # By Open3D, a peer.
)
"""The make targets that need something, whether it is there, and the Debian packages of it."""


def missing_packages(target: str) -> list[str]:
    """Return the Debian packages that `target` needs and that are missing."""
    needed = (row[1:] for row in NEEDED if target in row[0])
    return [package for is_there, packages in needed if not is_there() for package in packages]


def _loads(library: str) -> bool:
    try:
        ctypes.CDLL(library)
    except OSError:
        return False
    return True


def _runs(script: str, **environment: str) -> bool:
    """Return whether a script runs: which libraries it needs depends on the machine."""
    attempt = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, env={**os.environ, **environment}
    )
    return attempt.returncode == 0


def main() -> int:
    """Install the missing packages of the target on the command line; 0 if none is missing."""
    wanted = missing_packages(sys.argv[1]) if sys.platform.startswith("linux") else []
    if not wanted:
        return 0
    command = ["apt-get", "install", "-y", "--no-install-recommends", *wanted]
    if os.geteuid() != 0 or shutil.which("apt-get") is None:
        print(f"System packages are missing; please run: sudo {' '.join(command)}", file=sys.stderr)
        return 1
    print(f"Installing {', '.join(wanted)} ...", flush=True)
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    quiet = {"check": True, "env": environment, "stdout": subprocess.DEVNULL}
    subprocess.run(["apt-get", *WAIT, "update", "-qq"], **quiet)
    subprocess.run([command[0], *WAIT, *command[1:]], **quiet)
    return 0


if __name__ == "__main__":
    sys.exit(main())
