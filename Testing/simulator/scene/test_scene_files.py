import asyncio
from dataclasses import replace
from pathlib import Path

import pytest

from rastrainer.errors import InputError
from rastrainer_simulator.scene import scene_files as scene_files_module
from rastrainer_simulator.scene.scene_files import (
    SceneFiles,
    gzipped_scene,
    scene_key,
    scenes_folder,
    setup_digest,
)
from Testing.simulator.scene.glb_reader import Glb


@pytest.fixture(scope="module")
def built(setup, tmp_path_factory):
    """A folder with the scene without a task, and that scene."""
    folder = tmp_path_factory.mktemp("scenes")
    return folder, asyncio.run(SceneFiles(folder).scene(setup, ""))


@pytest.fixture
def no_process(monkeypatch):
    async def refuse(*_arguments, **_named):
        raise AssertionError("no scene is to be built")

    monkeypatch.setattr(scene_files_module.asyncio, "create_subprocess_exec", refuse)


def test_a_scene_is_built_in_a_separate_process_and_named_after_its_content(built):
    folder, file = built
    assert [path.suffix for path in folder.iterdir()] == [".glb"]
    content = file.path.read_bytes()
    assert Glb(content).children("head") == ["skin"]


@pytest.mark.usefixtures("no_process")
def test_a_scene_built_once_is_available_the_next_time(built, setup):
    folder, file = built
    files = SceneFiles(folder)
    assert asyncio.run(files.scene(setup, "")) == file
    assert files.by_hash == {file.sha256: file}


def test_a_broken_file_in_the_cache_is_rebuilt(built, setup, monkeypatch):
    folder, file = built
    content = file.path.read_bytes()

    async def build(_files, _setup, _task, path):
        path.write_bytes(content)

    monkeypatch.setattr(SceneFiles, "_build", build)
    file.path.write_bytes(content[:-1])
    with pytest.raises(LookupError):
        gzipped_scene(file)
    assert asyncio.run(SceneFiles(folder).scene(setup, "")) == file


def test_a_scene_that_cannot_be_built_is_reported_in_one_sentence(setup, tmp_path):
    scenario = replace(setup.scenario, folder=tmp_path / "gone")
    with pytest.raises(InputError, match=r"could not be built: .*gone does not exist"):
        asyncio.run(SceneFiles(tmp_path).scene(replace(setup, scenario=scenario), ""))


def test_the_key_changes_with_task_scenario_and_robot(setup):
    digest = setup_digest(setup)
    others = [
        replace(setup, scenario_sha256="0" * 64),
        replace(setup, robot=replace(setup.robot, meshes=setup.robot.meshes[:-1])),
        replace(setup, robot=replace(setup.robot, meshes=())),
    ]
    keys = {scene_key(digest, task) for task in ("", "task-1", "task-2")}
    keys |= {scene_key(setup_digest(other), "") for other in others}
    assert len(keys) == 6
    assert setup_digest(setup) == digest


def test_an_unwritable_cache_is_temporarily_replaced(tmp_path, monkeypatch):
    (tmp_path / "rastrainer").write_text("in the way")
    for variable in ("XDG_CACHE_HOME", "LOCALAPPDATA"):
        monkeypatch.setenv(variable, str(tmp_path))
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    folder = scenes_folder()
    assert folder.is_dir()
    assert not folder.is_relative_to(tmp_path)
    folder.rmdir()
