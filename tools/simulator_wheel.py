"""Build the simulator's wheel and put it next to the module, which sets the simulator up from it.

The module checks it by its SHA-256, in a file next to it. Neither is kept in git: a release builds
them, and CMake refuses to package the extension without them.

With `--repository`, write the tree that Slicer's Extensions Index registers into
build/extension-repository: the module, its CMake files, the simulator's wheel, README, license and
notices, and nothing else: the index clones a repository with its whole history, and reads every
file. The robot, the scenarios and the studies are in the wheel, from which CMake takes them.
"""

import hashlib
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RESOURCES = ROOT / "RASTrainer" / "Resources" / "RASTrainerSimulator"
TREE = ROOT / "build" / "extension-repository"
CONTENT = ("CMakeLists.txt", "LICENSE.txt", "NOTICE.md", "LICENSES", "RASTrainer")
README = Path("RASTrainer", "README.md")
PICTURES = ("Screenshots/residuals.jpg", "Screenshots/module-score.webp")
"""Pictures of the README; `CMakeLists.txt` shows the first in Slicer's list of extensions."""


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


def write_tree(wheel: Path, folder: Path) -> None:
    """Write the tree with a wheel of the simulator into a folder, and delete its old content.

    Only what git knows is copied, as it is now.
    """
    if folder.exists():
        shutil.rmtree(folder)
    command = ["git", "ls-files", "-z", "--", *CONTENT, *PICTURES]
    listed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True)
    for name in filter(None, listed.stdout.split("\0")):
        if not (ROOT / name).exists():
            continue
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(ROOT / name, folder / name)
    readme = (folder / README).read_text(encoding="utf-8").replace("](../", "](")
    (folder / README).unlink()
    (folder / "README.md").write_text(readme, encoding="utf-8")
    copy_beside_module(wheel, folder / "RASTrainer" / "Resources" / "RASTrainerSimulator")


def main() -> None:
    """Build the wheel, put it next to the module, or write the tree, and say where that is."""
    with tempfile.TemporaryDirectory() as temporary:
        try:
            wheel = build_wheel(Path(temporary))
            if sys.argv[1:] == ["--repository"]:
                write_tree(wheel, TREE)
            else:
                placed = copy_beside_module(wheel)
                print(f"The extension has its simulator: {placed.relative_to(ROOT)}.")
                return
        except subprocess.CalledProcessError:
            sys.exit("The wheel or the tree could not be written: see above.")
    sizes = [path.stat().st_size for path in TREE.rglob("*") if path.is_file()]
    print(f"{TREE.relative_to(ROOT)}: {len(sizes)} files, {sum(sizes) / 1e6:.1f} MB.")


if __name__ == "__main__":
    main()
