"""The programs of the guides to controlling and driving the robot do what the guides say."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from rastrainer.igtl.client import Client
from Testing.end_to_end.simulator_process import SimulatorProcess

GUIDES = Path(__file__).parents[2] / "docs" / "how-to"
PROGRAM = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
HELLO = {"protocolVersion": 1, "client": "watcher", "linksHz": 0, "steady": True}
LINES = 10


@pytest.fixture(scope="module")
def simulator(tmp_path_factory):
    records = tmp_path_factory.mktemp("guides") / "records"
    with SimulatorProcess(records, "--no-views", "--no-gamepad") as simulator:
        yield simulator


def program_of(guide, port):
    (program,) = PROGRAM.findall((GUIDES / guide).read_text(encoding="utf-8"))
    assert "port=18944" in program
    return [sys.executable, "-c", program.replace("18944", str(port))]


def tip(message):
    return np.array([row[3] for row in message.content.matrix[:3]])


def next_tip(client, condition=lambda _tip: True):
    """Return the next position of the tip (3,) float, World mm, that meets a condition."""
    last = client.latest.get("ToolTipToWorld")
    return tip(
        client.wait_for(
            "ToolTipToWorld", lambda news: news is not last and condition(tip(news)), timeout=60
        )
    )


def test_the_guides_adapter_moves_the_arm_as_the_picture_shows_and_lets_it_stop(simulator):
    with Client(port=simulator.port) as client:
        assert client.send_command("Hello", HELLO, timeout=60).ok
        task = client.send_command("ListTasks", {}, timeout=60).data["tasks"][0]["name"]
        start = {"task": task, "trainee": "T001", "seed": 1}
        assert client.send_command("StartTask", start, timeout=60).ok
        here = program_of("drive-with-another-device.md", simulator.port)
        first = next_tip(client)
        wrong = "nan nan nan\n-inf nan 0\n" * LINES + "0 0 up\n1 2 3 4\n"
        lines = "0 0 0.5\n0,0 0 0,5\n" * (LINES // 2) + wrong + "touch\nfaster\n"
        done = subprocess.run(here, input=lines, capture_output=True, text=True)
        assert done.returncode == 0
        up = next_tip(client, lambda tip: tip[2] > first[2])
        steps = [first, up]
        while np.any(steps[-1] != steps[-2]):
            steps.append(next_tip(client))
        np.testing.assert_allclose(steps[-1][:2], first[:2], atol=0.5)
        assert steps[-1][2] <= first[2] + LINES * 0.1 * 0.5 * 150.0
        assert client.send_command("Abort", {}, timeout=60).ok
    no_number, too_long, refused, unknown = done.stderr.splitlines()
    assert no_number == "not understood: 0 0 up"
    assert too_long == "not understood: 1 2 3 4"
    assert refused.startswith("Capture: ")
    assert unknown == "not understood: faster"


def test_the_guides_program_begins_a_trial_moves_the_arm_and_learns_why_a_touch_is_refused(
    simulator,
):
    here = program_of("control-from-a-program.md", simulator.port)
    done = subprocess.run(here, capture_output=True, text=True)
    assert done.stderr == ""
    begun, moved, refused = done.stdout.splitlines()
    assert re.fullmatch(r"\S+ has begun; point 1 is next\.", begun)
    assert moved == "The tip has come down by 2 cm."
    assert refused.endswith(".")
    assert refused != "Touched."
