"""The results of the tour: a table of its steps, pictures, and the errors in Slicer's log."""

from __future__ import annotations

import json
import re
import time
import traceback
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import slicer

_ERROR = re.compile(r"^\[(ERROR|CRITICAL|FATAL)\]")
_ENTRY = re.compile(r"^\[[A-Z]+\]\[")


@dataclass(frozen=True)
class Step:
    """One step of the tour."""

    name: str
    ok: bool
    seconds: float
    note: str = ""


class Record:
    """Does the steps, and writes their results."""

    def __init__(self, folder: Path, panel: Any) -> None:
        """`panel` is the module's widget, which is in the pictures where there is no window."""
        self.steps: list[Step] = []
        self._folder = folder
        self._panel = panel
        self._log = Path(slicer.app.errorLogModel().filePath)
        self._begin = self._log.stat().st_size if self._log.is_file() else 0
        folder.mkdir(parents=True, exist_ok=True)

    def do(self, name: str, function: Callable[[], str | None]) -> bool:
        """Do one step, which returns a note or raises; return whether it went well."""
        begin = time.monotonic()
        try:
            note, ok = function() or "", True
        except Exception as error:  # The tour continues, to find what else is broken.
            note, ok = f"{type(error).__name__}: {error}", False
            print(traceback.format_exc(), flush=True)
        step = Step(name, ok, round(time.monotonic() - begin, 2), note)
        self.steps.append(step)
        print(f"{'ok    ' if ok else 'FAILED'} {step.seconds:7.2f} s  {name}  {note}", flush=True)
        self._picture(f"{len(self.steps):02d}-{re.sub('[^a-z0-9]+', '-', name.lower())}.png")
        return ok

    def errors(self) -> list[str]:
        """Return what Slicer has logged as an error since the tour began."""
        if not self._log.is_file():
            return [f"There is no log {self._log}."]
        entries: list[str] = []
        is_error = False
        for line in self._log.read_bytes()[self._begin :].decode("utf-8", "replace").splitlines():
            if _ENTRY.match(line):
                is_error = bool(_ERROR.match(line))
                if is_error:
                    entries.append(line)
            elif is_error:
                entries[-1] += f"\n{line}"
        return entries

    def write(self, unused: list[str]) -> bool:
        """Write `tour.json` and `tour.md`, print the table, and return whether all is well.

        `unused` are the names of the buttons that no step has clicked.
        """
        errors = self.errors()
        about = {"slicer": slicer.app.applicationVersion, "system": slicer.app.os}
        steps = [asdict(step) for step in self.steps]
        whole = {**about, "steps": steps, "errors": errors, "unused": unused}
        (self._folder / "tour.json").write_text(json.dumps(whole, indent=1), encoding="utf-8")
        table = self._table(errors, unused, about)
        (self._folder / "tour.md").write_text(table, encoding="utf-8")
        print(table, flush=True)
        return all(step.ok for step in self.steps) and not errors

    def _table(self, errors: list[str], unused: list[str], about: dict[str, str]) -> str:
        lines = [f"# Tour in Slicer {about['slicer']}, {about['system']}", ""]
        lines += ["| step | ok | seconds | note |", "|---|---|---|---|"]
        for step in self.steps:
            note = step.note.replace("|", "\\|").replace("\n", " ")
            lines.append(
                f"| {step.name} | {'yes' if step.ok else 'NO'} | {step.seconds} | {note} |"
            )
        lines += ["", f"Buttons that no step has clicked: {', '.join(unused) or 'none'}."]
        lines += ["", f"## Errors in Slicer's log: {len(errors)}", ""]
        return "\n".join([*lines, *(f"```\n{error}\n```" for error in errors)]) + "\n"

    def _picture(self, name: str) -> None:
        window = slicer.util.mainWindow() or self._panel
        window.grab().save(str(self._folder / name))
