"""Allowed imports: layers of rooms (folders), read from every import, also those for types.

The folders of the page are layers, too.
"""

from __future__ import annotations

import ast
import functools
import re
import sys
from collections.abc import Iterable, Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
MODULE = ROOT / "RASTrainer" / "RASTrainer.py"
FOLDERS = {
    "rastrainer": ROOT / "RASTrainer" / "Logic" / "rastrainer",
    "rastrainer_simulator": ROOT / "RASTrainerSimulatorServer" / "rastrainer_simulator",
    "rastrainer_headless": ROOT / "RASTrainerSimulatorServer" / "rastrainer_headless",
}

# A room imports rooms of lines above its own, and nothing else of ours; rooms on one line do not
# know each other.
LAYERS = {
    "the domain": """
        rastrainer
        rastrainer.files, rastrainer.igtl
        rastrainer.head
        rastrainer.registration
        rastrainer.procedure
        rastrainer.motion, rastrainer.scenario
        rastrainer.journal
        rastrainer.trial
        rastrainer.decision
        rastrainer.study.database
        rastrainer.study.protocol
        rastrainer.study.curriculum
        rastrainer.study
    """,
    "Slicer's side": """
        rastrainer.slicer
        rastrainer.slicer.scene
        rastrainer.slicer.link
        rastrainer.slicer.program
        rastrainer.slicer.head
        rastrainer.widgets
        rastrainer.sections
        rastrainer_headless
        RASTrainer
    """,
    "the simulator": """
        rastrainer_simulator
        rastrainer_simulator.export, rastrainer_simulator.statistics
        rastrainer_simulator.report
        rastrainer_simulator.input, rastrainer_simulator.robot, rastrainer_simulator.texts
        rastrainer_simulator.collision, rastrainer_simulator.teleoperation
        rastrainer_simulator.ops, rastrainer_simulator.training
        rastrainer_simulator.core
        rastrainer_simulator.record, rastrainer_simulator.scene
        rastrainer_simulator.loop, rastrainer_simulator.rendering
        rastrainer_simulator.viewpoint
        rastrainer_simulator.presentation
        rastrainer_simulator.authoring, rastrainer_simulator.virtual
        rastrainer_simulator.decision
        rastrainer_simulator.net
        rastrainer_simulator.net.igtl, rastrainer_simulator.net.views
        rastrainer_simulator.replay
        rastrainer_simulator.flow.session
        rastrainer_simulator.flow.pages
        rastrainer_simulator.flow
        rastrainer_simulator.board, rastrainer_simulator.rating
        rastrainer_simulator.server
        rastrainer_simulator.cli
    """,
}
# The tables that a table's rooms may import from.
BELOW = {"the domain": (), "Slicer's side": ("the domain",), "the simulator": ("the domain",)}

# Foreign packages that a part may import; None means anything that its package requires.
OUTSIDE = {"the domain": {*sys.stdlib_module_names, "numpy", "scipy", "fastcrc"}}
FORBIDDEN = {
    "rastrainer.slicer": {"qt", "ctk"},
    "rastrainer_simulator": {"slicer", "qt", "ctk"},
}


def floors(table: str) -> list[list[str]]:
    return [line.strip(" ,").split(", ") for line in LAYERS[table].strip().splitlines()]


TABLE_OF = {room: table for table in LAYERS for floor in floors(table) for room in floor}
FLOOR_OF = {
    room: number for table in LAYERS for number, floor in enumerate(floors(table)) for room in floor
}


def module_name(path: Path) -> str:
    for name, folder in FOLDERS.items():
        if path.is_relative_to(folder):
            parts = path.relative_to(folder).with_suffix("").parts
            return ".".join((name, *(part for part in parts if part != "__init__")))
    raise AssertionError(path)


FILES = {
    module_name(path): path for folder in FOLDERS.values() for path in sorted(folder.rglob("*.py"))
}
FILES[MODULE.stem] = MODULE


def room_of(module: str) -> str:
    if FILES[module] == MODULE:
        return module
    is_package = FILES[module].name == "__init__.py"
    return module if is_package else module.rpartition(".")[0]


@functools.cache
def nodes_of(module: str) -> list[ast.AST]:
    """Return all statements and expressions of a file; each is read once, by the first test."""
    return list(ast.walk(ast.parse(FILES[module].read_text(encoding="utf-8"))))


def imported(module: str) -> Iterator[str]:
    for node in nodes_of(module):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module} imports relatively; the rule is absolute imports"
            for alias in node.names:
                full = f"{node.module}.{alias.name}"
                yield full if full in FILES else node.module


@functools.cache
def imports() -> dict[str, list[str]]:
    return {module: sorted(set(imported(module))) for module in FILES}


@functools.cache
def our_imports() -> dict[str, list[str]]:
    return {
        module: [name for name in names if name in FILES] for module, names in imports().items()
    }


def test_every_room_is_on_a_floor():
    assert {room_of(module) for module in FILES if FILES[module].name != "__init__.py"} == set(
        TABLE_OF
    )


def may_import(room: str, other: str) -> bool:
    if TABLE_OF[room] != TABLE_OF[other]:
        return TABLE_OF[other] in BELOW[TABLE_OF[room]]
    return room == other or FLOOR_OF[other] < FLOOR_OF[room]


def test_a_room_imports_only_from_rooms_above_its_line():
    upward = [
        f"{module} → {other}"
        for module, others in our_imports().items()
        for other in others
        if "__init__.py" not in (FILES[module].name, FILES[other].name)
        and not may_import(room_of(module), room_of(other))
    ]
    assert not upward


def test_no_file_imports_itself_through_others():
    try:
        TopologicalSorter(our_imports()).prepare()
    except CycleError as error:
        pytest.fail(" → ".join(error.args[1]))


def named_in_strings(module: str) -> set[str]:
    """Return our modules that a file's strings name, such as a process to start; not docstrings."""
    prose = {node.value for node in nodes_of(module) if isinstance(node, ast.Expr)}
    texts = [
        node.value
        for node in nodes_of(module)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in prose
    ]
    return {name for text in texts for name in re.findall(r"rastrainer[\w.]+", text)} & set(FILES)


def all_imported_by(*modules: str) -> set[str]:
    """Return modules of ours with all that they need in the end, also by name."""
    reached: set[str] = set()
    found = set(modules)
    while found:
        module = found.pop()
        reached.add(module)
        package = module.rpartition(".")[0]
        named = {package, *our_imports()[module], *named_in_strings(module)}
        found |= named & FILES.keys() - reached
    return reached


def test_slicer_reaches_every_module_of_its_extension():
    extension = {name for name, path in FILES.items() if path.is_relative_to(MODULE.parent)}
    assert extension - all_imported_by(MODULE.stem) == set()


def outsiders(modules: Iterable[str]) -> set[str]:
    names = {name.partition(".")[0] for module in modules for name in imports()[module]}
    return names - set(FOLDERS)


def test_the_domain_needs_only_numpy_scipy_and_the_standard_library():
    domain = (module for module in FILES if TABLE_OF.get(room_of(module)) == "the domain")
    assert outsiders(domain) <= OUTSIDE["the domain"]


def test_the_logic_of_each_section_works_without_qt():
    logic = [module for module in FILES if re.fullmatch(r"rastrainer\.sections\.\w+_logic", module)]
    assert len(logic) > 10
    assert not outsiders(all_imported_by(*logic)) & {"qt", "ctk"}


@pytest.mark.parametrize("part", FORBIDDEN)
def test_slicer_and_qt_parts_are_imported_only_where_allowed(part):
    modules = (module for module in FILES if f"{module}.".startswith(f"{part}."))
    assert not outsiders(modules) & FORBIDDEN[part]


PAGE = ROOT / "RASTrainerSimulatorServer" / "web" / "src"
PAGE_FLOORS = (
    ("texts", "."),
    ("stream",),
    ("audio", "panels"),
    ("scene",),
    ("input", "overlay"),
    ("xr",),
    ("board", "page"),
)


def imported_by_page(path: Path) -> list[Path]:
    """Return the page's own files that a file imports."""
    named = re.findall(r'(?:from|import) "(\.[^"]+)"', path.read_text(encoding="utf-8"))
    places = [(path.parent / name).resolve() for name in named]
    return [place if place.suffix == ".json" else place.with_suffix(".ts") for place in places]


def test_a_folder_of_the_page_imports_only_from_layers_above_its_own():
    files = {path: imported_by_page(path) for path in PAGE.rglob("*.ts")}
    folder = {path: path.relative_to(PAGE).parent.as_posix() for path in PAGE.rglob("*.*")}
    floor_of = {name: number for number, names in enumerate(PAGE_FLOORS) for name in names}
    assert {folder[path] for path in files} == set(floor_of)
    upward = [
        f"{path} → {other}"
        for path, others in files.items()
        for other in others
        if floor_of[folder[other]] > floor_of[folder[path]]
        or (floor_of[folder[other]] == floor_of[folder[path]] > 0 and folder[other] != folder[path])
    ]
    assert upward == []
    TopologicalSorter(files).prepare()
