"""Every link, path and module that the documentation names exists."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

from Testing.pictures import MOST_BYTES
from tools import reference_pages

ROOT = Path(__file__).parents[1]
TRACKED = [
    name
    for name in subprocess.run(
        ["git", "ls-files", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    ).stdout.splitlines()
    if (ROOT / name).exists()
]
PAGES = [name for name in TRACKED if name.endswith(".md") and name != "CHANGELOG.md"]
"""The changelog names what existed once."""
TOP = {name.split("/")[0] for name in TRACKED if "/" in name}
PLACES = {"/" + place for name in TRACKED for place in (name, *map(str, Path(name).parents))}
"""Every file and folder of the repository."""
SOURCES = ("RASTrainer/Logic/", "RASTrainerSimulatorServer/")
MODULES = {
    name[len(source) :].removesuffix("/__init__.py").removesuffix(".py").replace("/", ".")
    for name in TRACKED
    for source in SOURCES
    if name.startswith(source) and name.endswith(".py")
}
IN_USERS_FOLDERS = {
    f"RASTrainer/{name}" for name in ("scenarios", "simulator", "study.db", "trials")
}
BUILT = ("RASTrainerSimulatorServer/web/node_modules",)

CODE = re.compile(r"`([^`\n]+)`")
LINK = re.compile(r"\]\(([^)#\s]*)(?:#([^)\s]*))?\)")
FENCE = re.compile(r"^```.*?^```$", re.MULTILINE | re.DOTALL)
SHELL = re.compile(r"^(?:```sh\n.*?^```| {4,8}\S.*?)$", re.MULTILINE | re.DOTALL)
RUN = re.compile(r"python3? -m ((?:rastrainer|Testing)[\w.]*)")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)
SOURCE_FILE = re.compile(r"^[\w./-]+/[\w.-]+\.(?:py|ts|ui|md|json|cmake|toml|txt|lock|png|csv)$")
MODULE = re.compile(r"^(rastrainer(?:_simulator|_headless)?(?:\.[A-Za-z_]\w*)+)$")


def text_of(page: str) -> str:
    """Return a page without its blocks of code."""
    return FENCE.sub("", (ROOT / page).read_text(encoding="utf-8"))


def anchors(page: str) -> set[str]:
    """Return the anchors that GitHub gives the headings of a page."""
    plain = (re.sub(r"[`*]|\]\([^)]*\)|\[", "", text) for text in HEADING.findall(text_of(page)))
    return {re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-") for text in plain}


def paths_in(page: str) -> set[str]:
    """Return the paths of the repository that a page has as code."""
    words = {word for span in CODE.findall(text_of(page)) for word in span.split()}
    paths = {word.split("::")[0].split("#")[0].rstrip("/,;:") for word in words}
    return {path for path in paths if is_path(path)} - IN_USERS_FOLDERS


def is_path(word: str) -> bool:
    """Return whether a word names a file or folder of the repository, and no pattern of names."""
    if any(sign in word for sign in "*…<>{}") or word.startswith(("~", "/", "http", "build/")):
        return False
    return ("/" in word and word.split("/")[0] in TOP) or bool(SOURCE_FILE.match(word))


def is_there(path: str) -> bool:
    """Return whether a path, or the end of one such as `flow/screen.py`, is in the repository."""
    return path.startswith(BUILT) or any(place.endswith("/" + path) for place in PLACES)


def names_in(page: str) -> set[tuple[str, str]]:
    """Return what a page names within files, as by `training/training.py::Training._undo`."""
    words = {word for span in CODE.findall(text_of(page)) for word in span.split()}
    return {tuple(word.split("::")) for word in words if ".py::" in word}


def is_named(path: str, name: str) -> bool:
    """Return whether the file whose path ends like this defines a name; `A.b` is b within A."""
    files = [tracked for tracked in TRACKED if f"/{tracked}".endswith(f"/{path}")]
    sources = [(ROOT / file).read_text(encoding="utf-8") for file in files]
    parts = name.split(".")
    patterns = [rf"\b(?:def|class) {part}\b|^[\w, ]*\b{part}\b.*=" for part in parts]
    return any(
        all(re.search(pattern, source, re.MULTILINE) for pattern in patterns) for source in sources
    )


def is_module(name: str) -> bool:
    """Return whether a dotted name is a module, or a name that is defined in one."""
    parts = name.split(".")
    for length in range(len(parts), 0, -1):
        module = ".".join(parts[:length])
        if module in MODULES:
            files = (f"{module.replace('.', '/')}{end}" for end in (".py", "/__init__.py"))
            return length == len(parts) or any(is_named(file, parts[length]) for file in files)
    return False


@pytest.mark.parametrize("page", PAGES)
def test_every_link_path_module_and_name_on_a_page_exists(page):
    text, folder = (ROOT / page).read_text(encoding="utf-8"), (ROOT / page).parent
    assert re.findall(r"^(?:<{7}|>{7}) .*$", text, re.MULTILINE) == [], "conflict markers"
    for target, anchor in LINK.findall(text_of(page)):
        if target.startswith(("http:", "https:", "mailto:")):
            continue
        place = (folder / target).resolve() if target else ROOT / page
        assert place.exists(), target
        if anchor and place.suffix == ".md":
            assert anchor in anchors(place.relative_to(ROOT).as_posix()), f"{target}#{anchor}"
    assert {path for path in paths_in(page) if not is_there(path)} == set()
    words = {word for block in SHELL.findall(text) for word in block.split()}
    paths = {word for word in words if "/" in word and word.split("/")[0] in TOP}
    assert {path for path in paths if not is_there(path)} == set()
    run = {name.replace(".", "/") for name in RUN.findall(text)}
    assert {path for path in run if not (is_there(path) or is_there(f"{path}.py"))} == set()
    named = {match[1] for span in CODE.findall(text_of(page)) if (match := MODULE.match(span))}
    assert {name for name in named if not is_module(name)} == set()
    assert {named for named in names_in(page) if not is_named(*named)} == set()


def test_the_architecture_page_describes_every_folder():
    described = set(CODE.findall(text_of("docs/architecture.md")))
    packages = [place for source in SOURCES for place in (ROOT / source).glob("rastrainer*")]
    folders = [
        folder.name
        for package in packages
        for folder in package.iterdir()
        if list(folder.glob("*.py"))
    ]
    assert len(folders) > 20
    # `slicer` is described by its own folders.
    assert {name for name in folders if name not in described} <= {"slicer"}


def test_the_reference_pages_list_the_records():
    for name, page in reference_pages.pages().items():
        assert (reference_pages.FOLDER / name).read_text(encoding="utf-8") == page


MOST_FILM_BYTES = 5_000_000


def test_every_picture_of_the_documentation_is_small_and_shown_on_a_page():
    shown = " ".join((ROOT / page).read_text(encoding="utf-8") for page in PAGES)
    for folder in ("Screenshots", "docs/pictures"):
        pictures = [name for name in TRACKED if name.startswith(f"{folder}/")]
        assert pictures
        assert [name for name in pictures if (ROOT / name).stat().st_size > MOST_BYTES] == []
        assert [name for name in pictures if Path(name).name not in shown] == []
    (film,) = [name for name in TRACKED if name.endswith(".webm")]
    assert (ROOT / film).stat().st_size <= MOST_FILM_BYTES
    assert film in shown
