"""Write the tree that Slicer's Extensions Index registers into build/extension-repository.

It holds the module, its CMake files, the simulator's wheel, README, license and notices, and
nothing else: the index clones a repository with its whole history, and reads every file. The robot,
the scenarios and the studies are in the wheel, from which CMake takes them.
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from simulator_wheel import build_wheel, copy_beside_module

ROOT = Path(__file__).resolve().parents[1]
TREE = ROOT / "build" / "extension-repository"
CONTENT = ("CMakeLists.txt", "LICENSE.txt", "NOTICE.md", "LICENSES", "RASTrainer")
README = Path("RASTrainer", "README.md")
PICTURES = ("Screenshots/residuals.jpg", "Screenshots/module-score.webp")
"""Pictures of the README; `CMakeLists.txt` shows the first in Slicer's list of extensions."""


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
    """Build the wheel, write the tree and print its path and size."""
    with tempfile.TemporaryDirectory() as temporary:
        try:
            write_tree(build_wheel(Path(temporary)), TREE)
        except subprocess.CalledProcessError:
            sys.exit("The tree could not be written: see above.")
    sizes = [path.stat().st_size for path in TREE.rglob("*") if path.is_file()]
    print(f"{TREE.relative_to(ROOT)}: {len(sizes)} files, {sum(sizes) / 1e6:.1f} MB.")


if __name__ == "__main__":
    main()
