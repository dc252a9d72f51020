"""Scenarios as zip files, and malicious zip files."""

import stat
import zipfile

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.scenario.library import pack, unpack
from rastrainer.scenario.scenario import load_scenario
from rastrainer.scenario.writer import write_scenario
from Testing.domain.scenario.made_up_scenario import ball_head, ball_volume, made_up_scenario


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "source"
    folder.mkdir()
    write_scenario(folder, made_up_scenario(), ball_head(), ball_head(80.0), ball_volume())
    (folder / "preview.png").write_bytes(b"picture")
    (folder / "patient-name.txt").write_text("not to be given away")
    return folder


@pytest.fixture
def library(tmp_path):
    return tmp_path / "library"


def members(folder):
    """The files of the scenario's package, by name."""
    package = folder.parent / "good.zip"
    if not package.exists():
        pack(folder, package)
    with zipfile.ZipFile(package) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def zip_of(path, files):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return path


def refused(package, library, sentence):
    with pytest.raises(InputError, match=sentence) as caught:
        unpack(package, library)
    assert "\n" not in str(caught.value)
    assert not library.exists() or not list(library.iterdir())
    outside = {path.name for path in library.parent.iterdir()}
    assert outside <= {"source", "good.zip", "bad.zip", "library"}


def test_a_scenario_is_packed_and_unpacked(folder, library):
    package = pack(folder, folder.parent / "good.zip")
    goal = unpack(package, library)
    assert goal == library / "ball"
    scenario, original = load_scenario(goal), load_scenario(folder)
    assert np.array_equal(scenario.tasks[0].fiducials, original.tasks[0].fiducials)
    assert scenario.head.read_bytes() == original.head.read_bytes()
    assert scenario.volume.file.read_bytes() == original.volume.file.read_bytes()
    assert scenario.preview.read_bytes() == b"picture"
    assert not (goal / "patient-name.txt").exists()
    again = pack(goal, folder.parent / "again.zip")
    assert again.read_bytes() == package.read_bytes()


def test_nothing_is_overwritten(folder, library):
    package = pack(folder, folder.parent / "good.zip")
    with pytest.raises(InputError, match="already exists"):
        pack(folder, package)
    goal = unpack(package, library)
    before = (goal / "scenario.json").stat().st_mtime_ns
    with pytest.raises(InputError, match=r"ball is in .* already"):
        unpack(package, library)
    assert (goal / "scenario.json").stat().st_mtime_ns == before


@pytest.mark.parametrize(
    "name",
    [
        "../evil.txt",
        "/etc/evil.txt",
        "C:\\evil.txt",
        "C:evil.txt",
        "..\\evil.txt",
        "tasks//x",
        "CON.txt",
        "name\n.txt",
        "Übung\\..\\..\\böse.txt",
    ],
)
def test_a_path_out_of_the_folder_is_refused(folder, library, name):
    bad = zip_of(folder.parent / "bad.zip", {**members(folder), name: b"x"})
    refused(bad, library, "holds a file with the path")


BY_HAND = {
    ".DS_Store": b"x",
    "__MACOSX/._scenario.json": b"x",
    "__MACOSX/tasks/._task-1.mrk.json": b"x",
    "Für Anna, bitte lesen.txt": b"Viel Erfolg!",
    "a/b/c/d/e/f.txt": b"x",
    "x" * 200: b"x",
}


@pytest.mark.parametrize("base", ["", "ball/", "Übung 1/Kopf/", "Übung\\Kopf\\"], ids=ascii)
def test_a_package_that_a_person_zipped_again_is_unpacked_without_what_else_was_in_it(
    folder, library, base
):
    files = {base + name: content for name, content in members(folder).items()}
    if base.endswith("\\"):
        files = {name.replace("/", "\\"): content for name, content in files.items()}
    again = {**BY_HAND, **files, f"{base}Anmerkung für dich.txt": b"x", f"{base}.hidden": b"x"}
    goal = unpack(zip_of(folder.parent / "again.zip", again), library)
    unpacked = {path.relative_to(goal).as_posix() for path in goal.rglob("*") if path.is_file()}
    assert unpacked == {*members(folder)}


PYRAMID_WITHOUT_BASE = (
    b"ply\nformat ascii 1.0\ncomment SPACE=RAS\nelement vertex 5\nproperty float x\n"
    b"property float y\nproperty float z\nelement face 4\nproperty list uchar int vertex_indices\n"
    b"end_header\n-90 -90 0\n90 -90 0\n90 90 0\n-90 90 0\n0 0 90\n"
    b"3 0 1 4\n3 1 2 4\n3 2 3 4\n3 3 0 4\n"
)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (
            lambda files: {f"{n}/{name}": files[name] for n in "ab" for name in files},
            "several scen",
        ),
        (lambda files: {**files, **{f"f{n}": b"" for n in range(100)}}, "holds .* files"),
        (lambda files: {**files, "HEAD.PLY": b"x"}, "holds a file twice"),
        (lambda files: {**files, "scenario.json": b"{"}, r"scenario\.json"),
        (lambda files: {**files, "head.ply": b"ply"}, r"head\.ply"),
        (lambda files: {**files, "head.ply": PYRAMID_WITHOUT_BASE}, r"head\.ply is not closed"),
    ],
    ids=["two scenarios", "many", "twice", "JSON", "mesh", "open mesh"],
)
def test_a_package_of_anything_but_one_sound_scenario_is_refused(folder, library, change, sentence):
    bad = zip_of(folder.parent / "bad.zip", change(members(folder)))
    refused(bad, library, sentence)


def test_a_link_is_refused(folder, library):
    files = members(folder)
    bad = folder.parent / "bad.zip"
    with zipfile.ZipFile(bad, "w") as archive:
        for name, content in files.items():
            archive.writestr(name, content)
        link = zipfile.ZipInfo("link.txt")
        link.external_attr = (stat.S_IFLNK | 0o777) << 16
        archive.writestr(link, "/etc/passwd")
    refused(bad, library, "holds a link or a device")


def test_a_zip_bomb_is_stopped_by_its_unpacked_size(folder, library, monkeypatch):
    monkeypatch.setattr("rastrainer.scenario.library.MAX_BYTES", 3_000_000)
    bomb = zip_of(folder.parent / "bad.zip", {**members(folder), "bomb.bin": bytes(20_000_000)})
    refused(bomb, library, "holds more than 3 MB")


def test_texts_in_a_volume_are_not_packed(folder):
    path = folder / "volume.nrrd"
    magic, rest = path.read_bytes().split(b"\n", 1)
    path.write_bytes(magic + b"\ncontent: Mustermann\nPatientName:=Mustermann\n" + rest)
    assert b"Mustermann" not in members(folder)["volume.nrrd"]


@pytest.mark.parametrize("content", [b"", b"no zip", b"PK\x03\x04" + bytes(100)])
def test_a_file_that_is_not_a_zip_file_is_refused(folder, library, content):
    bad = folder.parent / "bad.zip"
    bad.write_bytes(content)
    refused(bad, library, "is not a zip file, or is damaged")
