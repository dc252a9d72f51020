"""A site's own limits: what the file may set, and that the simulator keeps to it."""

import json

import pytest

from rastrainer.errors import InputError
from rastrainer.igtl.client import Client, LinkError
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer_simulator.net.limits import (
    LIMITS_FILE,
    LinkLimits,
    ServerLimits,
    ViewLimits,
    read_limits,
)
from Testing.end_to_end.simulator_process import SimulatorProcess

HELLO = {"protocolVersion": PROTOCOL_VERSION, "client": "a site"}


def write(folder, content):
    folder.mkdir(exist_ok=True)
    (folder / LIMITS_FILE).write_text(content if isinstance(content, str) else json.dumps(content))


def test_limits_missing_from_the_file_keep_their_defaults(tmp_path):
    write(tmp_path, {"clients": {"clients": 3, "slowClientS": 2}, "views": {"views": 5}})
    assert read_limits(tmp_path) == ServerLimits(
        LinkLimits(clients=3, slow_client_s=2), ViewLimits(views=5)
    )


@pytest.mark.parametrize(
    ("content", "sentence"),
    [
        ("{", "limits.json"),
        ({"robots": {}}, 'there is no "robots"; use clients, views, trials.'),
        ({"clients": {"clients": 0}}, "clients.clients must be a whole number above 0"),
        ({"clients": {"slowClientS": 1e9}}, "slowClientS must be a number above 0, up to 864"),
        ('{"clients": {"slowClientS": NaN}}', "limits.json"),
    ],
)
def test_an_invalid_limit_is_refused_with_what_would_be_valid(tmp_path, content, sentence):
    write(tmp_path, content)
    with pytest.raises(InputError) as refused:
        read_limits(tmp_path)
    assert sentence in str(refused.value)


def test_the_simulator_accepts_no_more_clients_and_trials_than_the_file_allows(tmp_path):
    trials = {"startsPerS": 1e-6, "startsAtOnce": 1}
    write(tmp_path / "records-config", {"clients": {"clients": 1}, "trials": trials})
    task = {"task": "task-1", "trainee": "P01"}
    with SimulatorProcess(tmp_path / "records", "--no-views") as simulator:
        with Client(port=simulator.port) as client:
            assert client.send_command("Hello", HELLO, timeout=60).ok
            with pytest.raises(LinkError), Client(port=simulator.port) as one_more:
                one_more.send_command("Hello", HELLO, timeout=60)
            assert client.send_command("Hello", HELLO, timeout=60).ok
            assert client.send_command("StartTask", task, timeout=60).ok
            assert client.send_command("Abort", timeout=60).ok
            assert "too often" in client.send_command("StartTask", task, timeout=60).error
        assert simulator.stop()[0] == 0
