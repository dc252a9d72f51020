"""The available scenarios: those of RASTrainer and those in the user's folder."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.scenario.scenario import FILE_NAME, load_scenario

MAX_SCENARIOS = 200
MAX_PICTURE_BYTES, MAX_PICTURE_PIXELS = 4_000_000, 2048
"""Of a picture in a list, along each side: what views decode at once, wherever it comes from."""

_PNG_START = struct.Struct(">8s4x4sII")


@dataclass(frozen=True)
class ListedScenario:
    """An entry in a list of scenarios.

    Attributes:
        name, title: of the scenario; the folder's name if it is unusable.
        folder: its folder.
        preview: path of its picture, a PNG; None if missing or unusable.
        problem: why it is unusable; empty otherwise.
    """

    name: str
    title: str
    folder: Path
    preview: Path | None
    problem: str


def user_library() -> Path:
    """Return the folder of the user's scenarios, which may not exist."""
    return Path.home() / "RASTrainer" / "scenarios"


def list_scenarios(
    libraries: Iterable[Path], list_one: Callable[[Path], ListedScenario] | None = None
) -> list[ListedScenario]:
    """Return the scenarios in the subfolders of these folders, by title.

    Unusable ones are listed with their problem. Of two with the same name, the first folder's is
    listed.

    Args:
        libraries: folders of folders.
        list_one: lists the scenario of a folder; by default `list_folder`.
    """
    folders = [
        path.parent
        for library in libraries
        for path in sorted(Path(library).glob(f"*/{FILE_NAME}"))[:MAX_SCENARIOS]
    ]
    return list_folders(folders, list_one)


def list_folders(
    folders: Iterable[Path], list_one: Callable[[Path], ListedScenario] | None = None
) -> list[ListedScenario]:
    """Return the scenarios in these folders themselves, otherwise like `list_scenarios`."""
    listed: dict[str, ListedScenario] = {}
    for folder in folders:
        entry = (list_one or list_folder)(folder)
        listed.setdefault(entry.name, entry)
    return sorted(listed.values(), key=lambda entry: entry.title.casefold())


def list_folder(folder: Path) -> ListedScenario:
    """Return the entry of a folder, with its problem if unusable."""
    try:
        scenario = load_scenario(folder)
    except InputError as error:
        return ListedScenario(folder.name, folder.name, folder, None, str(error))
    preview = scenario.preview
    shown = preview if preview is not None and _is_picture(preview) else None
    return ListedScenario(scenario.name, scenario.title, folder, shown, "")


def _is_picture(path: Path) -> bool:
    """Return whether a file starts as a PNG of a size that every view supports."""
    try:
        if path.stat().st_size > MAX_PICTURE_BYTES:
            return False
        with path.open("rb") as file:
            start = file.read(_PNG_START.size)
    except OSError:
        return False
    if len(start) < _PNG_START.size:
        return False
    signature, chunk, width, height = _PNG_START.unpack(start)
    is_png = signature == b"\x89PNG\r\n\x1a\n" and chunk == b"IHDR"
    return is_png and 0 < width <= MAX_PICTURE_PIXELS and 0 < height <= MAX_PICTURE_PIXELS
