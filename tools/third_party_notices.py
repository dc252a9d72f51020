"""Write build/third-party-notices.txt: the packages that come with RASTrainer, and their licenses.

It describes the installed packages: those that requirements/base.lock names, with their
metadata and license files, and the packages that go into the browser page.
"""

import importlib.metadata
import json
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LOCK = ROOT / "requirements" / "base.lock"
WEB = ROOT / "RASTrainerSimulatorServer" / "web"
OUTPUT = ROOT / "build" / "third-party-notices.txt"
LONGEST_FILE = 200_000
MAX_FILES = 24
"""Per package; the files nearest to its top have its license."""
RULE = "=" * 100
INTRODUCTION = """RASTrainer is under the MIT license (LICENSE.txt).
It is installed with the packages below, each under its own license; none is in its repository.
"""
_LEGAL = re.compile(r"(licen[cs]e|notice|copying|authors)", re.IGNORECASE)
_TEXT_SUFFIXES = ("", ".txt", ".md", ".rst", ".APACHE", ".BSD", ".PSF")
_LOCKED = re.compile(r"^([A-Za-z0-9][A-Za-z0-9._-]*)==", re.MULTILINE)


@dataclass(frozen=True)
class Notice:
    """The notice of one package."""

    name: str
    version: str
    license: str
    home: str
    texts: tuple[str, ...]

    def __str__(self) -> str:
        head = f"{self.name} {self.version}\nLicense: {self.license or 'see below'}\n{self.home}"
        return "\n\n".join((RULE + "\n" + head.rstrip(), *self.texts)) + "\n"


def python_notices() -> Iterator[Notice]:
    """Yield the notice of each package of the lock that is installed here, by name."""
    for name in sorted(set(_LOCKED.findall(LOCK.read_text(encoding="utf-8")))):
        try:
            package = importlib.metadata.distribution(name)
        except importlib.metadata.PackageNotFoundError:
            continue  # The lock is for every system; this package belongs to another.
        metadata = package.metadata
        links = [entry.partition(", ")[2] for entry in metadata.get_all("Project-URL") or []]
        home = metadata.get("Home-page") or (links[0] if links else "")
        files = [
            file
            for file in package.files or ()
            if _LEGAL.search(file.name) and file.suffix in _TEXT_SUFFIXES
        ]
        files.sort(key=lambda file: (len(file.parts), str(file)))
        paths = [Path(str(package.locate_file(file))) for file in files[:MAX_FILES]]
        texts = tuple(_text(path) for path in paths if path.is_file())
        yield Notice(metadata["Name"], package.version, _license(metadata), home, texts)


def page_notices() -> Iterator[Notice]:
    """Yield the notice of each package that goes into the page, not of what only builds it."""
    lock = json.loads((WEB / "package-lock.json").read_text(encoding="utf-8"))
    for place, entry in sorted(lock["packages"].items()):
        folder = WEB / place
        if not place or entry.get("dev") or not folder.is_dir():
            continue
        files = sorted(path for path in folder.iterdir() if _LEGAL.search(path.name))
        texts = tuple(_text(path) for path in files if path.is_file())
        name = place.rpartition("node_modules/")[2]
        yield Notice(name, entry["version"], entry.get("license", ""), "", texts)


def write_notices(output: Path = OUTPUT) -> int:
    """Write all notices and return the number of packages."""
    notices = [*python_notices(), *page_notices()]
    output.parent.mkdir(parents=True, exist_ok=True)
    output.write_text(INTRODUCTION + "\n" + "\n".join(map(str, notices)), encoding="utf-8")
    return len(notices)


def write_page_notices(output: Path) -> None:
    """Write the notices of what goes into the page; npm has installed it."""
    notices = list(page_notices())
    if not notices:
        raise RuntimeError("The packages of the page are not installed: its notices are missing.")
    output.write_text("\n".join(map(str, notices)), encoding="utf-8")


def _license(metadata: importlib.metadata.PackageMetadata) -> str:
    expression = metadata.get("License-Expression") or metadata.get("License") or ""
    if expression and len(expression) < 80 and "\n" not in expression:
        return expression
    classifiers = metadata.get_all("Classifier") or []
    return "; ".join(
        line.rpartition(" :: ")[2] for line in classifiers if line.startswith("License ::")
    )


def _text(path: Path) -> str:
    return path.read_bytes()[:LONGEST_FILE].decode("utf-8", "replace").strip()


if __name__ == "__main__":
    count = write_notices()
    print(f"The notices of {count} packages are in {OUTPUT.relative_to(ROOT)}.")
    sys.exit(0 if count else 1)
