"""The available scenarios, of RASTrainer and in the user's folder: listed, packed and unpacked.

A package is a zip file, and untrusted when it is unpacked.
"""

from __future__ import annotations

import re
import shutil
import stat
import struct
import tempfile
import uuid
import zipfile
import zlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.files.reading import printable_name
from rastrainer.head.mesh import read_head_mesh
from rastrainer.head.volume import check_place, read_head_volume
from rastrainer.home_folder import home_folder
from rastrainer.procedure.checks import unusable_lines
from rastrainer.procedure.plan import read_procedure_meshes
from rastrainer.scenario.scenario import FILE_NAME, PREVIEW_NAME, Scenario, load_scenario
from rastrainer.scenario.writer import new_folder, read_files, write_scenario
from rastrainer.work_progress import Progress, no_progress

MAX_SCENARIOS = 200
MAX_PICTURE_BYTES, MAX_PICTURE_PIXELS = 4_000_000, 2048
"""Limits of a picture in a list, pixels along each side: every view can decode it at once."""

_PNG_START = struct.Struct(">8s4x4sII")


@dataclass(frozen=True)
class ListedScenario:
    """An entry in a list of scenarios; `problem` is why one is unusable, and empty otherwise.

    Name and title of an unusable one are its folder's. `preview` is its picture, a PNG.
    """

    name: str
    title: str
    folder: Path
    preview: Path | None
    problem: str


USER_LIBRARY = "RASTrainer/scenarios"


def user_library() -> Path:
    """Return the folder of the user's scenarios, which may not exist."""
    return home_folder() / USER_LIBRARY


def list_scenarios(
    libraries: Iterable[Path], list_one: Callable[[Path], ListedScenario] | None = None
) -> list[ListedScenario]:
    """Return the scenarios in the subfolders of these folders, by title.

    Unusable scenarios are listed with their problem. The first folder's is listed if two have the
    same name. `list_one` lists the scenario of a folder; by default `list_folder`.
    """
    listed: dict[str, ListedScenario] = {}
    for library in libraries:
        for path in sorted(Path(library).glob(f"*/{FILE_NAME}"))[:MAX_SCENARIOS]:
            entry = (list_one or list_folder)(path.parent)
            listed.setdefault(entry.name, entry)
    return sorted(listed.values(), key=lambda entry: entry.title.casefold())


def list_folder(folder: Path) -> ListedScenario:
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
        with path.open("rb") as file:
            start = file.read(_PNG_START.size)
        if len(start) < _PNG_START.size or path.stat().st_size > MAX_PICTURE_BYTES:
            return False
    except OSError:
        return False
    signature, chunk, width, height = _PNG_START.unpack(start)
    is_png = signature == b"\x89PNG\r\n\x1a\n" and chunk == b"IHDR"
    return is_png and 0 < width <= MAX_PICTURE_PIXELS and 0 < height <= MAX_PICTURE_PIXELS


MAX_PACKED_BYTES = 64_000_000
MAX_BYTES = 100_000_000
MAX_FILES = 64
MAX_TRIANGLES = 100_000
"""More than in our own meshes (60,000); the limit of views and collision checks."""

UNPACKING, CHECKING = "Unpacking the scenario", "Checking the scenario"
UNPACKED_SHARE = 0.5

_TIME = (2000, 1, 1, 0, 0, 0)
_CHUNK = 1 << 20
_NAME = re.compile(r"[A-Za-z0-9_-][A-Za-z0-9._-]{0,79}(/[A-Za-z0-9_-][A-Za-z0-9._-]{0,79}){0,3}")
_DEVICES = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)


def pack(folder: Path, package: Path) -> Path:
    """Write a scenario as a zip file; the same scenario gives the same bytes.

    Other files in the folder are left out.
    """
    scenario, package = checked_scenario(folder), Path(package)
    if package.exists():
        raise InputError(f"{package} already exists; name a new file.")
    files = read_files(scenario)
    partial = package.parent / f".{uuid.uuid4().hex}.partial"
    try:
        with tempfile.TemporaryDirectory() as temporary:
            clean = Path(temporary)
            write_scenario(clean, scenario, *files)
            if scenario.preview:
                shutil.copyfile(scenario.preview, clean / PREVIEW_NAME)
            with zipfile.ZipFile(partial, "x", zipfile.ZIP_DEFLATED) as archive:
                for file in sorted(entry for entry in clean.rglob("*") if entry.is_file()):
                    info = zipfile.ZipInfo(file.relative_to(clean).as_posix(), _TIME)
                    info.compress_type = zipfile.ZIP_DEFLATED
                    info.external_attr = (stat.S_IFREG | 0o644) << 16
                    archive.writestr(info, file.read_bytes())
        partial.replace(package)
    except OSError as error:
        raise InputError(f"{package} cannot be written: {error.strerror}.") from None
    finally:
        partial.unlink(missing_ok=True)
    return package


def unpack(package: Path, library: Path, progress: Progress = no_progress) -> Path:
    """Unpack a scenario into a new folder of `library` named like it, and return the folder.

    If that fails, nothing is left behind.
    """
    package, library = Path(package), Path(library).absolute()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as temporary:
        folder = Path(temporary) / "scenario"
        folder.mkdir()
        _read_archive(package, folder, progress)
        progress(CHECKING, UNPACKED_SHARE)
        try:
            scenario = checked_scenario(folder)
        except InputError as error:
            # Remove the temporary folder from the message.
            sentence = str(error).replace(f"{folder.resolve()}/", "").replace(f"{folder}/", "")
            raise InputError(f"{package} cannot be used: {sentence}") from None
        goal = library / scenario.name
        if goal.exists():
            raise InputError(f"The scenario {scenario.name} is in {library} already.")
        progress(CHECKING, 1.0)
        with new_folder(goal) as made:
            shutil.copytree(folder, made, dirs_exist_ok=True)
    return goal


def checked_scenario(folder: Path) -> Scenario:
    """Load a scenario and check its meshes, its volume and the lines of its procedures."""
    scenario = load_scenario(folder)
    for path in [scenario.head, *([scenario.skull.file] if scenario.skull else [])]:
        mesh = read_head_mesh(path)
        if len(mesh.triangles) > MAX_TRIANGLES:
            raise InputError(
                f"The mesh {path} has {len(mesh.triangles)} triangles; a scenario's may have "
                f"{MAX_TRIANGLES}."
            )
        if path == scenario.head and not mesh.is_closed:
            raise InputError(f"The head mesh {path} is not closed: it has a hole.")
    if scenario.volume is not None:
        volume, head = read_head_volume(scenario.volume), read_head_mesh(scenario.head)
        check_place(volume, head, scenario.volume.file)
    require_usable_lines(scenario)
    return scenario


def require_usable_lines(scenario: Scenario) -> None:
    """Check that instruments can be placed along all trajectories of a scenario's procedures."""
    if scenario.skull is None or not scenario.procedures:
        return
    head = read_head_mesh(scenario.head)
    wrong = []
    for procedure in scenario.procedures:
        meshes = read_procedure_meshes(procedure, scenario.skull.file)
        wrong += unusable_lines(procedure, head, meshes.skull)
    if wrong:
        raise InputError(" ".join(wrong))


def _read_archive(package: Path, folder: Path, progress: Progress) -> None:
    try:
        if package.stat().st_size > MAX_PACKED_BYTES:
            raise _refused(package, f"is larger than {MAX_PACKED_BYTES // 10**6} MB")
        with zipfile.ZipFile(package) as archive:
            taken = _members(package, archive)
            if not 1 <= len(taken) <= MAX_FILES:
                raise _refused(
                    package, f"holds {len(taken)} files; a scenario has 1 to {MAX_FILES}"
                )
            left = MAX_BYTES
            for number, (name, info) in enumerate(taken.items()):
                progress(UNPACKING, UNPACKED_SHARE * number / len(taken))
                path = folder / name
                path.parent.mkdir(parents=True, exist_ok=True)
                # The declared size is ignored.
                with archive.open(info) as packed, path.open("xb") as file:
                    while chunk := packed.read(_CHUNK):
                        left -= len(chunk)
                        if left < 0:
                            raise _refused(package, f"holds more than {MAX_BYTES // 10**6} MB")
                        file.write(chunk)
    except FileNotFoundError:
        raise InputError(f"There is no file {package}.") from None
    except OSError as error:
        raise InputError(f"{package} cannot be unpacked: {error.strerror or error}.") from None
    except InputError:
        raise
    except (zipfile.BadZipFile, zlib.error, EOFError, RuntimeError, ValueError):
        raise _refused(package, "is not a zip file, or is damaged") from None


def _members(package: Path, archive: zipfile.ZipFile) -> dict[str, zipfile.ZipInfo]:
    """Return the files of a scenario in a package, by their paths in the scenario's folder.

    The folder may be inside other folders. People who pack it by hand also pack notes and system
    files: files with other names than ours are left out.
    """
    infos = [info for info in archive.infolist() if not info.is_dir()]
    # Some programs for Windows part folders by backslashes.
    named = [(info.filename.replace("\\", "/"), info) for info in infos]
    for name, info in named:
        parts = name.split("/")
        is_odd = not name.isprintable() or ":" in name or not {"", ".", ".."}.isdisjoint(parts)
        if is_odd or any(_DEVICES.fullmatch(part) or part.endswith(".") for part in parts):
            raise _refused(package, f"holds a file with the path {name[:80]!a}")
        kind = stat.S_IFMT(info.external_attr >> 16)
        if kind not in (0, stat.S_IFREG):
            raise _refused(package, f"holds a link or a device, {printable_name(name[:80])}")
        if info.flag_bits & 0x1:
            raise _refused(package, "is encrypted")
    if len({name.casefold() for name, _ in named}) != len(named):
        raise _refused(package, "holds a file twice")
    bases = [name.removesuffix(FILE_NAME) for name, _ in named if name.split("/")[-1] == FILE_NAME]
    base = min(bases, key=lambda each: each.count("/"), default="")
    if [each.count("/") for each in bases].count(base.count("/")) > 1:
        raise _refused(package, "holds several scenarios")
    inside = {name[len(base) :]: info for name, info in named if name.startswith(base)}
    return {name: info for name, info in inside.items() if _NAME.fullmatch(name)}


def _refused(package: Path, reason: str) -> InputError:
    return InputError(f"{package} {reason}: it is not a scenario package.")
