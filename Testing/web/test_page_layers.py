"""The page's folders are layers: each imports only those below, by every import statement."""

from __future__ import annotations

import re
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

SOURCES = Path(__file__).parents[2] / "RASTrainerSimulatorServer" / "web" / "src"
# A folder imports from lines above its own, and nothing else of ours; "." is what all use.
LAYERS = """
    texts
    .
    stream
    audio, panels
    scene
    input, overlay
    xr
    board, page
"""
FLOOR_OF = {
    folder: floor
    for floor, line in enumerate(LAYERS.split("\n"))
    for folder in re.findall(r"[\w.]+", line)
}
FILES = sorted(SOURCES.rglob("*.ts"))


def imported(path: Path) -> list[Path]:
    """Return the page's own files that a file imports."""
    named = re.findall(r'(?:from|import) "(\.[^"]+)"', path.read_text(encoding="utf-8"))
    places = [(path.parent / name).resolve() for name in named]
    return [place if place.suffix == ".json" else place.with_suffix(".ts") for place in places]


def folder_of(path: Path) -> str:
    return str(path.relative_to(SOURCES).parent)


def test_every_folder_of_the_page_is_in_a_layer_and_every_import_is_a_file():
    assert {folder_of(path) for path in FILES} == set(FLOOR_OF)
    assert [other for path in FILES for other in imported(path) if not other.is_file()] == []


@pytest.mark.parametrize("folder", FLOOR_OF)
def test_a_folder_of_the_page_imports_only_from_layers_above_its_own(folder):
    upward = [
        f"{path.relative_to(SOURCES)} → {other.relative_to(SOURCES)}"
        for path in FILES
        if folder_of(path) == folder
        for other in imported(path)
        if folder_of(other) != folder and FLOOR_OF[folder_of(other)] >= FLOOR_OF[folder]
    ]
    assert not upward


def test_the_page_has_no_import_cycles():
    try:
        TopologicalSorter({path: imported(path) for path in FILES}).prepare()
    except CycleError as error:
        pytest.fail(" → ".join(map(str, error.args[1])))
