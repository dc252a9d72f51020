"""Writes down which functions of the product a process calls while the file `recording` exists.

Python imports this module when it starts, wherever its folder is on `PYTHONPATH`;
`RASTRAINER_CALLED` names the folder of that file. Module bodies, class bodies, comprehensions and
lambdas do not count.
"""

import os
import sys
import threading
import time
from functools import partial
from inspect import CO_OPTIMIZED
from pathlib import Path

POLL_S = 0.005


class Recorder:
    """The functions called in this process, of all its threads."""

    def __init__(self, folder: Path) -> None:
        self._recording = folder / "recording"
        self._written = folder / f"called-{os.getpid()}.txt"
        self._is_on = self._recording.exists()
        self._called: set = set()
        threading.Thread(target=self._watch, daemon=True).start()

    def note(self, frame, event: str, _argument) -> None:
        """Note a call, as the profiler of a thread."""
        if self._is_on and event == "call":
            self._called.add(frame.f_code)

    def _watch(self) -> None:
        while True:
            is_on = self._recording.exists()
            if self._is_on and not is_on:
                self._write()
            self._is_on = is_on
            time.sleep(POLL_S)

    def _write(self) -> None:
        lines = {
            f"{code.co_filename}\t{code.co_name}:{code.co_firstlineno}"
            for code in list(self._called)
            if "rastrainer" in code.co_filename
            and not code.co_name.startswith("<")
            # Bodies of classes are not optimized.
            and code.co_flags & CO_OPTIMIZED
        }
        self._written.write_text("\n".join(sorted(lines)), encoding="utf-8")


def record(folder: str) -> None:
    recorder = Recorder(Path(folder))
    threading.setprofile(recorder.note)
    sys.setprofile(recorder.note)


if place := os.environ.get("RASTRAINER_CALLED"):
    record(place)
    # A forked process has no thread but one.
    os.register_at_fork(after_in_child=partial(record, place))
