"""The simulator as a lab runs it: a full disk, a clean end, its ports and its logs."""

from __future__ import annotations

import contextlib
import json
import resource
import signal
import socket
import subprocess
import urllib.error
import urllib.request

from rastrainer.igtl.client import Client
from rastrainer.igtl.content import Command, CommandReply
from rastrainer.igtl.message import Message, MessageReader, pack
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.protocol import DeviceName
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.record.trial_archive import SUFFIX
from Testing.end_to_end.simulator_process import COMMAND, SimulatorProcess, ViewedSimulator
from Testing.end_to_end.window_process import wait_until
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.simulator.net.views.served import ViewClient

TRAINEE = "Pseudonym-77"
UNLIMITED = (resource.RLIM_INFINITY, resource.RLIM_INFINITY)


def do(client, name, **arguments):
    return client.send_command(name, arguments, timeout=60)


def in_phase(client, phase):
    def is_so(message):
        return json.loads(message.content.text)["phase"] == phase

    return json.loads(client.wait_for(DeviceName.SIM_STATE, is_so, timeout=60).content.text)


def journal(folder):
    (path,) = folder.glob(f"*{SUFFIX}")
    return path


def test_on_a_full_disk_the_trial_pauses_with_a_message_and_resumes_once_there_is_room(tmp_path):
    records = tmp_path / "records"
    with (
        SimulatorProcess(records, "--no-views") as simulator,
        Client(port=simulator.port) as client,
    ):
        assert do(client, "StartTask", task="task-1", trainee=TRAINEE).ok
        assert do(client, "Pause").ok
        size = journal(records).stat().st_size
        # A file system in which the file may grow by some hundred bytes and no more.
        resource.prlimit(simulator.pid, resource.RLIMIT_FSIZE, (size + 300, UNLIMITED[1]))
        refused = do(client, "Resume")
        assert not refused.ok
        assert "could not be recorded and does not count" in refused.error
        assert "File too large" in refused.error
        client.wait_for(
            DeviceName.SIM_STATE,
            lambda message: "make room or choose another folder" in message.content.text,
            timeout=60,
        )
        resource.prlimit(simulator.pid, resource.RLIMIT_FSIZE, UNLIMITED)
        assert do(client, "Resume").ok
        in_phase(client, "running")
        status, _errors = simulator.stop()
    assert status == 0
    assert read_journal(journal(records)).integrity is Integrity.INTACT


def ended(folder):
    """Use a simulator with a view, a client and a trial, and end it.

    Return its exit status, its stderr, and its secrets.
    """
    with contextlib.ExitStack() as stack:
        thread = stack.enter_context(LoopThread())
        simulator = stack.enter_context(ViewedSimulator(folder / "records"))
        client = stack.enter_context(Client(port=simulator.port))
        view = stack.enter_context(ViewClient(thread, simulator.url, simulator.key))
        view.join()
        pairing = urllib.request.Request(f"{simulator.url}/pair", b'{"code": "000000"}')
        with contextlib.suppress(urllib.error.HTTPError):
            urllib.request.urlopen(pairing, timeout=60)
        with socket.create_connection(("127.0.0.1", simulator.port)) as stranger:
            # It may be closed before it has sent everything.
            with contextlib.suppress(OSError):
                stranger.sendall(b"no message at all" * 10_000)
            assert do(client, "StartTask", task="task-1", trainee=TRAINEE).ok
            log = folder / "records-config" / "logs" / "simulator-0.log"
            # That the trial runs is answered a moment before it is logged.
            wait_until(lambda: "The trial is running." in log.read_text(), "the line in the log")
            result = simulator.stop(signal.SIGTERM)
    return *result, (simulator.code, simulator.key)


def test_a_simulator_in_use_ends_cleanly_on_sigterm_and_logs_no_secret_and_no_pseudonym(tmp_path):
    status, errors, secrets = ended(tmp_path)
    assert status == 0
    reading = read_journal(journal(tmp_path / "records"))
    assert reading.integrity is Integrity.INTACT
    assert reading.entries[-1]["kind"] == "stopped"
    logs = tmp_path / "records-config" / "logs"
    lines = [json.loads(line) for line in (logs / "simulator-0.log").read_text().splitlines()]
    messages = [line["message"] for line in lines]
    assert messages[0] == "The simulator has started."
    assert "The simulator ends by SIGTERM." in messages
    assert messages[-1] == "The simulator has ended."
    assert any(line["level"] == "warning" for line in lines)
    written = "".join(path.read_text() for path in logs.iterdir())
    for secret in (*secrets, TRAINEE):
        assert secret not in written
        assert secret not in errors


def test_a_port_in_use_gives_one_sentence_and_status_2(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = str(other.getsockname()[1])
        places = ["--records", str(tmp_path / "records"), "--config", str(tmp_path / "config")]
        command = [*COMMAND, *places, "--port", port, "--no-views", "--no-gamepad"]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith(f"rastrainer: Cannot listen on 127.0.0.1:{port}")
    assert len(done.stderr.splitlines()) == 1


def test_a_wrong_argument_gives_one_sentence_and_status_2(tmp_path, capsys):
    places = ["--records", str(tmp_path), "--config", str(tmp_path)]
    for arguments, sentence in (
        (["--connect", "slicer"], "--connect must be HOST:PORT, such as 127.0.0.1:18944"),
        (["--scenario", "nowhere"], "The scenario's folder nowhere does not exist."),
    ):
        assert main(["simulator", *places, *arguments]) == 2
        said = capsys.readouterr().err
        assert sentence in said
        assert said.startswith("rastrainer: ")
        assert said.count("\n") == 1


def test_the_simulator_connects_to_a_listening_slicer_and_takes_its_commands(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as slicer:
        address = "{}:{}".format(*slicer.getsockname())
        with SimulatorProcess(tmp_path, "--no-views", "--connect", address) as simulator:
            assert simulator.ready == f"RASTrainer simulator ready; it connects to {address}"
            slicer.settimeout(60)
            connection, _address = slicer.accept()
            with connection:
                connection.settimeout(60)
                connection.sendall(pack(Message("command", Command(1, "ListTasks"))))
                reader, reply = MessageReader(), None
                while reply is None:
                    for message in reader.feed(connection.recv(65_536)):
                        if type(message.content) is CommandReply:
                            reply = message
            assert reply.metadata["Status"] == "SUCCESS"
            assert simulator.stop(signal.SIGINT) == (0, "")


def test_an_interrupted_trial_is_reported_on_the_terminal_and_left_alone_on_request(tmp_path):
    records = tmp_path / "records"
    with (
        SimulatorProcess(records, "--no-views") as simulator,
        Client(port=simulator.port) as client,
    ):
        assert do(client, "StartTask", task="task-1", trainee=TRAINEE).ok
        simulator.kill()
    with SimulatorProcess(records, "--no-views", "--no-resume") as simulator:
        with Client(port=simulator.port) as client:
            in_phase(client, "idle")
        assert simulator.stop()[0] == 0
    with SimulatorProcess(records, "--no-views") as simulator:
        assert simulator.next_line() == (
            f"RASTrainer simulator resumes the interrupted trial of {TRAINEE} at task-1: "
            "0 of 15 points are kept; resume or abort it"
        )
        assert simulator.stop(signal.SIGHUP)[0] == 0
