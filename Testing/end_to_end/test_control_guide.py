"""The program of the guide to controlling the robot does what the guide says."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from Testing.end_to_end.simulator_process import SimulatorProcess

GUIDE = Path(__file__).parents[2] / "docs" / "how-to" / "control-from-a-program.md"
PROGRAM = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def test_the_guides_program_begins_a_trial_moves_the_arm_and_learns_why_a_touch_is_refused(
    tmp_path,
):
    (program,) = PROGRAM.findall(GUIDE.read_text(encoding="utf-8"))
    assert "port=18944" in program
    with SimulatorProcess(tmp_path / "records", "--no-views", "--no-gamepad") as simulator:
        here = program.replace("18944", str(simulator.port))
        done = subprocess.run([sys.executable, "-c", here], capture_output=True, text=True)
    assert done.stderr == ""
    begun, moved, refused = done.stdout.splitlines()
    assert re.fullmatch(r"\S+ has begun; point 1 is next\.", begun)
    assert moved == "The tip has come down by 2 cm."
    assert refused.endswith(".")
    assert refused != "Touched."
