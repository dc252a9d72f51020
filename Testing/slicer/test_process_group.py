"""A program ends with everything it started, on every system."""

import subprocess
import sys
import time

from rastrainer.slicer.program.child_process import OPTIONS, endGroup

SLEEP_S = 600
PARENT = f"""
import subprocess, sys, time
child = subprocess.Popen([sys.executable, "-c", "import time; time.sleep({SLEEP_S})"])
print("ready", flush=True)
time.sleep({SLEEP_S})
"""


def test_a_program_ends_with_everything_it_started():
    begin = time.monotonic()
    words = [sys.executable, "-c", PARENT]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, **OPTIONS) as process:
        assert process.stdout.readline() == "ready\n"
        endGroup(process.pid, isAsked=False)
        # The child has the other end, too.
        assert process.stdout.read() == ""
    assert time.monotonic() - begin < SLEEP_S / 2
