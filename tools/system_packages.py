"""Install the system packages that a make target needs, or name the missing ones.

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
FIND_CHINESE_FONT = """
from rastrainer_simulator.ops.system_paths import chinese_font
raise SystemExit(chinese_font() is None)
"""
QT_NEEDS = ["libegl1", "libgl1", "libfontconfig1", "libxkbcommon0", "libdbus-1-3"]
OPENIGTLINK_HEADER = Path("/usr/include/openigtlink/igtlMessageHeader.h")
FONTS = Path("/usr/share/fonts/truetype")
REAL_HEADS = {
    "mricron-data": Path("/usr/share/mricron/templates/ch2.nii.gz"),
    "invesalius-examples": Path("/usr/share/doc/invesalius-examples/examples/Cranium.inv3"),
}
"""An MRI and a CT, only for tests; `make soak` makes scenarios of them."""

WAIT = ("-o", "DPkg::Lock::Timeout=300")
"""For another installation to end, s: many machines look for updates when they start."""


TESTS, TRAINING = ("test", "soak"), ("simulator", "test", "soak")


def missing_packages(target: str) -> list[str]:
    """Return the Debian packages that `target` needs and that are missing."""
    everything = (
        (None, lambda: _loads("libgomp.so.1"), ["libgomp1"]),
        (None, lambda: _runs(RENDER_ONE_PICTURE), ["libegl1", "libgl1-mesa-dri", "libxcursor1"]),
        (TRAINING, lambda: _loads("libGLX.so.0"), ["libgl1", "libglx-mesa0"]),
        (TESTS, lambda: shutil.which("g++"), ["g++", "libc6-dev"]),
        (TESTS, lambda: shutil.which("cmake"), ["cmake"]),
        (TESTS, OPENIGTLINK_HEADER.exists, ["libopenigtlink-dev"]),
        (TESTS, lambda: shutil.which("Xvfb"), ["xvfb"]),
        (TESTS, lambda: shutil.which("chromium"), ["chromium"]),
        (TESTS, FONTS.is_dir, ["fonts-dejavu-core"]),
        (TESTS, lambda: _runs(FIND_CHINESE_FONT), ["fontconfig", "fonts-wqy-microhei"]),
        (TESTS, lambda: _runs(OPEN_QT, QT_QPA_PLATFORM="offscreen"), QT_NEEDS),
        *((("soak",), file.exists, [package]) for package, file in REAL_HEADS.items()),
        (("soak",), lambda: list(Path("/usr/lib/postgresql").glob("*/bin/initdb")), ["postgresql"]),
        # Open3D, a peer, needs it.
        (("soak",), lambda: _loads("libusb-1.0.so.0"), ["libusb-1.0-0"]),
    )
    return [
        package
        for targets, is_there, packages in everything
        if (targets is None or target in targets) and not is_there()
        for package in packages
    ]


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
