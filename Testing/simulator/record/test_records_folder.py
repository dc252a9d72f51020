"""One simulator at a time records in a folder, and says why it cannot."""

import asyncio
import os
import signal
import tempfile
from pathlib import Path

import pytest

from rastrainer.commands import CommandName
from rastrainer.errors import InputError
from rastrainer_simulator.record.journal_writer import RecordsFolder
from rastrainer_simulator.server import server
from Testing.forked_child import in_child
from Testing.simulator.record.test_interrupted_trial import Server


def take(folder):
    try:
        RecordsFolder(folder)
    except InputError as error:
        return str(error)
    return "taken"


def test_a_second_simulator_is_refused_with_a_message_that_names_the_first(tmp_path):
    first = RecordsFolder(tmp_path)
    assert in_child(take, tmp_path) == (
        f"Another simulator (process {os.getpid()}) records in {tmp_path}: end it, or choose "
        "another folder with --records."
    )
    first.close()
    assert in_child(take, tmp_path) == "taken"


def take_without_permission(folder):
    if os.getuid() == 0:
        os.setuid(65534)
    return take(folder)


def test_a_read_only_folder_is_reported_before_anyone_plays():
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o555)
        said = in_child(take_without_permission, Path(folder))
        missing = in_child(take_without_permission, Path(folder, "trials"))
        Path(folder).chmod(0o755)
    assert said == (
        f"Trials cannot be recorded in {folder}: Permission denied. Allow writing to it, or "
        "choose another folder with --records."
    )
    assert "Permission denied" in missing


def journal_of_two_touches(simulation, folder):
    """Return the path of an interrupted trial's journal, and where its second touch begins."""
    with Server(simulation, folder) as running:
        running.start()
        assert running.do(CommandName.CAPTURE).ok
        path = running.path
        size = path.stat().st_size
        assert running.do(CommandName.CAPTURE).ok
    return path, path.read_bytes()[:size].rindex(b"\n") + 1


def resumed_while_another_server_touches(path, size, config):
    """Start a simulator while another one adds to a journal; return its message about the resumed
    trial.

    The other one leaves the folder in the moment in which the new one takes it.
    """
    whole = path.read_bytes()
    path.write_bytes(whole[:size])

    class Left(RecordsFolder):
        def __init__(self, folder):
            path.write_bytes(whole)
            super().__init__(folder)

    server.RecordsFolder = Left
    said = []

    def tell(words):
        said.append(words)
        if words.startswith("resumes"):
            signal.raise_signal(signal.SIGTERM)

    options = server.ServerOptions(path.parent, 1, port=0, has_views=False, config=config)
    asyncio.run(server.SimulatorServer(options).run(tell))
    return next(words for words in said if words.startswith("resumes"))


def test_a_simulator_continues_with_all_touches_another_one_recorded_before_it_left(
    simulation, tmp_path
):
    path, size = journal_of_two_touches(simulation, tmp_path / "records")
    said = in_child(resumed_while_another_server_touches, path, size, tmp_path / "config")
    assert "2 of 15 points are kept" in said


def test_a_simulator_that_cannot_start_releases_the_folder(tmp_path):
    nowhere = server.ServerOptions(tmp_path, 1, scenario=tmp_path / "none", config=tmp_path)
    with pytest.raises(InputError, match="does not exist"):
        server.SimulatorServer(nowhere)
    RecordsFolder(tmp_path).close()
