"""Removes what the simulator never opens from a private folder of packages; a separate program.

    private_command(python, FOLDER, "rastrainer.slicer.program.trim_packages", FOLDER)

Wheels bring C++ headers, manuals and tests, and VTK and Pinocchio a hundred libraries that the
simulator does not use. Nothing is guessed: every package that its sources import is imported, and
libraries that the loader has not opened by then are removed. If an import fails, or the system does
not list loaded libraries, all stay. On Linux, a fourth of their bytes are symbols for debuggers,
which no loader reads.

Prints one line and writes the sizes into SIZES, next to the packages.
"""

from __future__ import annotations

import ast
import importlib
import importlib.util
import json
import os
import shutil
import struct
import sys
from collections.abc import Iterator
from pathlib import Path

from rastrainer.python_environment import mapped_files

SIZES = "rastrainer-sizes.json"
SOURCES = ("rastrainer_simulator", "rastrainer")
SLICERS_OWN = ("slicer", "sections", "widgets")
"""Below `rastrainer`: what only Slicer runs."""
NEVER_OPENED = (
    "cmeel.prefix/include",
    "cmeel.prefix/bin",
    "cmeel.prefix/share",
    "cmeel.prefix/lib/cmake",
    "cmeel.prefix/lib/pkgconfig",
    "pygame/docs",
    "pygame/examples",
    "pygame/tests",
    "vtkmodules/test",
    "vtk.data",
)
TESTS = "tests"
"""Folders of this name below any package."""
BUILDING_ONLY = ("*.a", "*.lib", "*.pyi", "*.pxd", "*.pyx")
MANY_LIBRARIES = ("vtkmodules", "cmeel.prefix/lib")
MEGABYTE = 10**6


def trim(folder: Path) -> tuple[int, int]:
    """Remove files that are never opened; return the kept and the removed bytes."""
    before = size(folder)
    for name in NEVER_OPENED:
        shutil.rmtree(folder / name, ignore_errors=True)
    for tests in [path for path in folder.rglob(TESTS) if path.is_dir()]:
        shutil.rmtree(tests, ignore_errors=True)
    for pattern in BUILDING_ONLY:
        for path in list(folder.rglob(pattern)):
            path.unlink()
    loaded = loaded_libraries(folder)
    for name in MANY_LIBRARIES if loaded else ():
        for path in _libraries(folder / name):
            if path.name not in loaded:
                path.unlink()
    for path in _libraries(folder):
        drop_symbols(path)
    after = size(folder)
    return after, before - after


def size(folder: Path) -> int:
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def loaded_libraries(folder: Path) -> set[str]:
    """Return the names of all libraries that are loaded once the simulator's packages are.

    Empty where that is not known.
    """
    if not mapped_files():
        return set()
    names = sorted(third_party_imports(folder))
    try:
        for name in names:
            importlib.import_module(name)
        return {Path(path).name for path in mapped_files()}
    except Exception as error:  # a broken library may raise anything
        print(f"The libraries stay as they are: {error}", flush=True)
        return set()


def third_party_imports(folder: Path) -> set[str]:
    """Return the installed modules that the simulator's sources import, wherever they do."""
    names: set[str] = set()
    for path in _sources(folder):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Import):
                names.update(alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names.add(node.module)
    own = {*sys.stdlib_module_names, *SOURCES}
    foreign = {name for name in names if name.partition(".")[0] not in own}
    return {name for name in foreign if importlib.util.find_spec(name.partition(".")[0])}


def _sources(folder: Path) -> Iterator[Path]:
    for package in SOURCES:
        found = importlib.util.find_spec(package)
        root = Path(found.origin).parent if found and found.origin else folder / package
        for path in root.rglob("*.py"):
            if path.relative_to(root).parts[0] not in SLICERS_OWN:
                yield path


def _libraries(folder: Path) -> list[Path]:
    found = (path for path in folder.rglob("*.so*") if path.suffix == ".so" or ".so." in path.name)
    return [path for path in found if path.is_file()]


ELF_64_LITTLE = b"\x7fELF\x02\x01"
ELF_HEADER = struct.Struct("<16s2HI3QI6H")
"""Identification, type, machine, version, entry, offsets of segments and of sections, flags, sizes
of this header and of a segment's, number of segments, size of a section's header, number of
sections, number of the section with their names (System V ABI, chapter 4)."""
SEGMENT = struct.Struct("<2I6Q")
"""Type, flags, offset, two addresses, bytes in the file, bytes in memory, alignment."""


def drop_symbols(library: Path) -> None:
    """Cut off all bytes behind the last segment: symbols and sections, which only debuggers read.

    Other than 64-bit libraries of Linux stay as they are.
    """
    content = library.read_bytes()
    if not content.startswith(ELF_64_LITTLE):
        return
    header = list(ELF_HEADER.unpack_from(content))
    first, size, count = header[5], header[9], header[10]
    segments = [SEGMENT.unpack_from(content, first + place * size) for place in range(count)]
    end = max(first + count * size, *(segment[2] + segment[5] for segment in segments))
    header[6] = header[12] = header[13] = 0
    shorter = library.with_name(f"{library.name}.shorter")
    # Not in place: the library may be loaded, or linked to from elsewhere.
    shorter.write_bytes(ELF_HEADER.pack(*header) + content[ELF_HEADER.size : end])
    shutil.copymode(library, shorter)
    shorter.replace(library)


def main() -> None:
    os.environ["PYGAME_HIDE_SUPPORT_PROMPT"] = "1"
    folder = Path(sys.argv[1]).resolve()
    kept, removed = trim(folder)
    text = json.dumps({"keptBytes": kept, "removedBytes": removed})
    (folder / SIZES).write_text(text + "\n", encoding="utf-8")
    print(
        f"{removed // MEGABYTE} MB that are never opened were removed; {kept // MEGABYTE} MB stay."
    )


if __name__ == "__main__":
    main()
