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
OPENIGTLINK_HEADER = Path("/usr/include/openigtlink/igtlMessageHeader.h")
FONTS = Path("/usr/share/fonts/truetype")
REAL_HEADS = {
    "mricron-data": Path("/usr/share/mricron/templates/ch2.nii.gz"),
    "invesalius-examples": Path("/usr/share/doc/invesalius-examples/examples/Cranium.inv3"),
}
"""An MRI and a CT, only for tests; `make soak` makes scenarios of them."""

WAIT = ("-o", "DPkg::Lock::Timeout=300")
"""For another installation to end, s: many machines look for updates when they start."""


def missing_packages(target: str) -> list[str]:
    """Return the Debian packages that `target` needs and that are missing."""
    wanted = []
    if not _loads("libgomp.so.1"):
        wanted += ["libgomp1"]
    if not _runs(RENDER_ONE_PICTURE):
        wanted += ["libegl1", "libgl1-mesa-dri", "libxcursor1"]
    if target in ("simulator", "test", "soak") and not _loads("libGLX.so.0"):
        wanted += ["libgl1", "libglx-mesa0"]
    if target == "simulator" and os.environ.get("DISPLAY") and not _runs(FIND_BROWSER):
        wanted += ["chromium"]
    if target in ("test", "soak"):
        wanted += _for_tests()
    if target == "soak":
        wanted += [package for package, file in REAL_HEADS.items() if not file.exists()]
        if not list(Path("/usr/lib/postgresql").glob("*/bin/initdb")):
            wanted += ["postgresql"]
        if not _loads("libusb-1.0.so.0"):  # By Open3D, a peer.
            wanted += ["libusb-1.0-0"]
    return wanted


def _for_tests() -> list[str]:
    """Return the missing packages of the tests."""
    wanted = []
    if shutil.which("g++") is None:
        wanted += ["g++", "libc6-dev"]
    if shutil.which("cmake") is None:
        wanted += ["cmake"]
    if not OPENIGTLINK_HEADER.exists():
        wanted += ["libopenigtlink-dev"]
    if shutil.which("Xvfb") is None:
        wanted += ["xvfb"]
    if shutil.which("chromium") is None:
        wanted += ["chromium"]
    if not FONTS.is_dir():
        wanted += ["fonts-dejavu-core"]
    if not _runs(FIND_CHINESE_FONT):
        wanted += ["fontconfig", "fonts-wqy-microhei"]
    if not _runs(OPEN_QT, QT_QPA_PLATFORM="offscreen"):
        wanted += ["libegl1", "libgl1", "libfontconfig1", "libxkbcommon0", "libdbus-1-3"]
    return wanted


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
