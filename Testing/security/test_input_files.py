"""Every loader refuses malicious input files with a sentence."""

import json
import os
import shutil
import sqlite3
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import trimesh

from rastrainer.errors import InputError
from rastrainer.files.point_files import read_markups, read_points
from rastrainer.head.volume import read_nrrd, write_nrrd
from rastrainer.procedure.plan import read_procedure
from rastrainer.scenario.library import checked_scenario
from rastrainer.scenario.scenario import load_scenario
from rastrainer.scenario.setup import read_setup
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.trial.ctps import read_notes
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.flow.session.preferences import (
    Preferences,
    read_preferences,
    write_preferences,
)
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS, read_bindings, write_bindings
from rastrainer_simulator.robot.meshes import load_meshes
from rastrainer_simulator.robot.model import load_robot
from Testing.security.hostile_content import HOSTILE_JSON, mutations

SCENARIO = asset_path("scenarios", "colin27")
STUDIES = asset_path("studies")
TASK = SCENARIO / "tasks" / "task-1.mrk.json"


class Family(NamedTuple):
    """A kind of file: its loader and a good file's bytes."""

    read: Callable[[Path], object]
    good: Callable[[Path], bytes]
    name: str = "file.json"


def _saved(write: Callable[[Path], None]) -> Callable[[Path], bytes]:
    def content(folder: Path) -> bytes:
        write(folder / "saved.json")
        return (folder / "saved.json").read_bytes()

    return content


def _scenario(path: Path) -> object:
    """Load the shipped scenario with another `scenario.json`."""
    folder = path.parent / "scenario"
    if not folder.is_dir():
        shutil.copytree(SCENARIO, folder)
    shutil.copyfile(path, folder / "scenario.json")
    return load_scenario(folder)


def _volume(path: Path) -> object:
    """Read a volume; if it is not refused, it has voxels and a place in space."""
    values, matrix = read_nrrd(path)
    assert values.dtype in (np.uint8, np.int16)
    assert values.ndim == 3
    assert np.isfinite(np.linalg.inv(matrix)).all()
    assert matrix[3].tolist() == [0.0, 0.0, 0.0, 1.0]
    return values, matrix


def _write_volume(path: Path) -> None:
    """Write images so small that damage often meets the header."""
    values = np.random.default_rng(8).integers(-1000, 1000, (8, 7, 6), dtype=np.int16)
    write_nrrd(path, values, np.diag([1.0, 2.0, 3.0, 1.0]))


JSON_FAMILIES = {
    "scenario": Family(_scenario, lambda _: (SCENARIO / "scenario.json").read_bytes()),
    "procedure": Family(
        read_procedure,
        lambda _: json.dumps(
            json.loads((SCENARIO / "scenario.json").read_bytes())["procedures"][0]
        ).encode(),
    ),
    "set-up": Family(read_setup, lambda _: b'{"robotBaseMm": [0, 0]}'),
    "markups": Family(read_markups, lambda _: TASK.read_bytes()),
    "study protocol": Family(
        StudyProtocol.read, lambda _: (STUDIES / "published-protocol.json").read_bytes()
    ),
    "curriculum": Family(
        Curriculum.read, lambda _: (STUDIES / "example-curriculum.json").read_bytes()
    ),
    "study notes": Family(read_notes, lambda _: (STUDIES / "published.json").read_bytes()),
    "bindings": Family(read_bindings, _saved(lambda path: write_bindings(path, DEFAULT_BINDINGS))),
    "preferences": Family(
        read_preferences, _saved(lambda path: write_preferences(path, Preferences()))
    ),
}
OTHER_FAMILIES = {
    "points": Family(read_points, lambda _: b"label,x,y,z\n1,1,2,3\n2,4,5,6\n3,7,8,9\n", "p.csv"),
    "volume": Family(_volume, _saved(_write_volume), "volume.nrrd"),
}
FAMILIES = {**JSON_FAMILIES, **OTHER_FAMILIES}


def refused(family: Family, path: Path) -> str:
    """Return the sentence with which a file is refused."""
    with pytest.raises(InputError) as caught:
        family.read(path)
    sentence = str(caught.value)
    assert sentence.count("\n") == 0
    assert len(sentence) < 1000
    return sentence


@pytest.mark.parametrize("family", JSON_FAMILIES.values(), ids=JSON_FAMILIES.keys())
def test_malicious_json_is_refused_by_every_loader(tmp_path, family):
    for content in HOSTILE_JSON.values():
        (tmp_path / "file.json").write_bytes(content)
        assert "file" in refused(family, tmp_path / "file.json") or "scenario" in str(family)


@pytest.mark.parametrize("family", FAMILIES.values(), ids=FAMILIES.keys())
def test_special_and_oversized_files_are_refused_unread_by_every_loader(tmp_path, family):
    path = tmp_path / family.name
    with path.open("wb") as file:
        file.truncate(20 * 2**30)
    if family.read is not _scenario:  # which copies it first
        assert "larger than" in refused(family, path)
    path.unlink()
    if hasattr(os, "mkfifo") and family.read is not _scenario:
        os.mkfifo(path)
        refused(family, path)
        path.unlink()
    path.mkdir()
    if family.read is not _scenario:
        refused(family, path)


@pytest.mark.parametrize("family", FAMILIES.values(), ids=FAMILIES.keys())
def test_a_damaged_file_is_read_or_refused_and_breaks_nothing(tmp_path, family):
    path = tmp_path / family.name
    good = family.good(tmp_path)
    path.write_bytes(good)
    family.read(path)
    outcomes = set()
    for content in mutations(good, 30, seed=9):
        path.write_bytes(content)
        try:
            family.read(path)
            outcomes.add("read")
        except InputError:
            outcomes.add("refused")
    assert "refused" in outcomes


def _mesh(kind: str) -> bytes:
    content = trimesh.creation.box((0.1, 0.1, 0.1)).export(file_type=kind)
    return content if isinstance(content, bytes) else content.encode()


@pytest.mark.parametrize("kind", ["stl", "ply", "obj"])
def test_a_damaged_mesh_is_read_or_refused_and_breaks_nothing(tmp_path, kind):
    path = tmp_path / f"link_7.{kind}"
    path.write_bytes(_mesh(kind))
    whole = load_robot(mesh_folder=tmp_path)
    # The other links' meshes are not damaged.
    robot = replace(whole, meshes=tuple(part for part in whole.meshes if part.path == path))
    assert load_meshes(robot)
    for content in mutations(_mesh(kind), 40, seed=10):
        path.write_bytes(content)
        try:
            meshes = load_meshes(robot)
        except InputError:
            continue
        assert all(np.isfinite(mesh.vertices).all() for mesh, _ in meshes["iiwa_link_7"])


def test_a_scenarios_files_stay_in_its_folder(tmp_path):
    folder = tmp_path / "scenario"
    shutil.copytree(SCENARIO, folder)
    shutil.copyfile(SCENARIO / "head.ply", tmp_path / "head.ply")
    (folder / "link.ply").symlink_to(tmp_path / "head.ply")
    good = json.loads((folder / "scenario.json").read_text(encoding="utf-8"))
    for name in ("../head.ply", str(tmp_path / "head.ply"), "link.ply", "tasks/../../head.ply"):
        (folder / "scenario.json").write_text(json.dumps({**good, "head": name}))
        with pytest.raises(InputError, match="inside the scenario's folder"):
            load_scenario(folder)


def test_a_damaged_head_is_read_or_refused_and_breaks_nothing(tmp_path):
    folder = tmp_path / "scenario"
    shutil.copytree(SCENARIO, folder)
    good = (SCENARIO / "head.ply").read_bytes()
    for content in mutations(good[:400], 8, seed=11):
        (folder / "head.ply").write_bytes(content + good[400:])
        try:
            checked_scenario(folder)
        except InputError:
            continue


def test_a_study_with_embedded_sql_commands_is_refused(tmp_path):
    path = tmp_path / "study.db"
    Study.open(path).close()
    with sqlite3.connect(path) as database:
        database.execute(
            "CREATE TRIGGER evil AFTER INSERT ON trainees BEGIN DELETE FROM trials; END"
        )
    with pytest.raises(InputError, match="triggers or views"):
        Study.open(path)
