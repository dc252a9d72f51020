"""The adapter of the guide to other devices drives the arm as the guide says."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np

from rastrainer.igtl.client import Client
from Testing.end_to_end.simulator_process import SimulatorProcess

GUIDE = Path(__file__).parents[2] / "docs" / "how-to" / "drive-with-another-device.md"
PROGRAM = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
HELLO = {"protocolVersion": 1, "client": "watcher", "linksHz": 0, "steady": True}
LINES = 10


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


def test_the_guides_adapter_moves_the_arm_as_the_picture_shows_and_lets_it_stop(tmp_path):
    (program,) = PROGRAM.findall(GUIDE.read_text(encoding="utf-8"))
    assert "port=18944" in program
    with (
        SimulatorProcess(tmp_path / "records", "--no-views", "--no-gamepad") as simulator,
        Client(port=simulator.port) as client,
    ):
        assert client.send_command("Hello", HELLO, timeout=60).ok
        task = client.send_command("ListTasks", {}, timeout=60).data["tasks"][0]["name"]
        start = {"task": task, "trainee": "T001", "seed": 1}
        assert client.send_command("StartTask", start, timeout=60).ok
        here = [sys.executable, "-c", program.replace("18944", str(simulator.port))]
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
    no_number, too_long, refused, unknown = done.stderr.splitlines()
    assert no_number == "not understood: 0 0 up"
    assert too_long == "not understood: 1 2 3 4"
    assert refused.startswith("Capture: ")
    assert unknown == "not understood: faster"
