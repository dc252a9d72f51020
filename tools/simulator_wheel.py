"""Build the simulator's wheel and put it next to the module, which sets the simulator up from it.

The module checks it by its SHA-256, in a file next to it. Neither is kept in git: a release builds
them, and CMake refuses to package the extension without them.
"""

import hashlib
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RESOURCES = ROOT / "RASTrainer" / "Resources" / "RASTrainerSimulator"


def build_wheel(folder: Path) -> Path:
    """Build the wheel by the packages of this Python, into a folder, and return its path."""
    words = ["--no-deps", "--no-build-isolation", "--no-cache-dir", "-q", "-w", str(folder)]
    subprocess.run([sys.executable, "-m", "pip", "wheel", *words, str(ROOT)], check=True)
    (wheel,) = folder.glob("*.whl")
    return wheel


def copy_beside_module(wheel: Path, folder: Path = RESOURCES) -> Path:
    """Put a wheel and its SHA-256 into a folder, in place of another's; return the wheel there."""
    for other in folder.glob("*.whl*"):
        other.unlink()
    content = wheel.read_bytes()
    digest = hashlib.sha256(content).hexdigest()
    placed = folder / wheel.name
    placed.write_bytes(content)
    text = f"{digest}  {wheel.name}\n"
    placed.with_name(f"{wheel.name}.sha256").write_text(text, encoding="utf-8")
    return placed


def main() -> None:
    """Build the wheel, put it next to the module and print its path."""
    with tempfile.TemporaryDirectory() as temporary:
        try:
            wheel = copy_beside_module(build_wheel(Path(temporary)))
        except subprocess.CalledProcessError:
            sys.exit("The wheel could not be built: see above.")
    print(f"The extension has its simulator: {wheel.relative_to(ROOT)}.")


if __name__ == "__main__":
    main()
