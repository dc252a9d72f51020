"""The simulator's process: its start, its end, and its errors if it cannot start."""

from __future__ import annotations

import signal
import socket
import subprocess

import pytest

from rastrainer.igtl.client import Client
from rastrainer.igtl.content import Command, CommandReply
from rastrainer.igtl.message import Message, MessageReader, pack
from rastrainer_simulator.cli.main import main
from Testing.end_to_end.simulator_process import COMMAND, SimulatorProcess


def test_simulator_exits_cleanly_on_ctrl_c_while_a_client_is_connected(tmp_path):
    with SimulatorProcess(tmp_path) as simulator, Client(port=simulator.port) as client:
        client.wait_for("ToolTipToWorld", timeout=60)
        assert simulator.stop(signal.SIGINT) == (0, "")


def test_simulator_connects_to_a_listening_slicer_and_takes_its_commands(tmp_path):
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


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--port", "99999"], "--port: must be a whole number from 0 to 65535"),
        (["--speed", "0"], "--speed: must be a number from 0.001 to 1000.0"),
        (["--speed", "nan"], "--speed: must be a number from 0.001 to 1000.0"),
        (["--seed", "-1"], "--seed: must be a whole number from 0 to 9223372036854775807"),
        (["--connect", "slicer"], "--connect must be HOST:PORT, such as 127.0.0.1:18944"),
        (["--scenario", "nowhere"], "The scenario's folder nowhere does not exist."),
    ],
)
def test_wrong_argument_gives_one_sentence_and_status_2(tmp_path, capsys, arguments, sentence):
    places = ["--records", str(tmp_path), "--config", str(tmp_path)]
    assert main(["simulator", *places, *arguments]) == 2
    said = capsys.readouterr().err
    assert sentence in said
    assert said.startswith("rastrainer: ")
    assert said.count("\n") == 1


def test_port_in_use_gives_one_sentence_and_status_2(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = str(other.getsockname()[1])
        places = ["--records", str(tmp_path), "--config", str(tmp_path)]
        command = [*COMMAND, *places, "--no-views", "--port", port]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 2
    assert done.stderr.startswith(f"rastrainer: Cannot listen on 127.0.0.1:{port}")
    assert len(done.stderr.splitlines()) == 1
