"""Whether the files of the settings can be read: some end the start, others are passed over."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer_simulator.controls import bindings_file
from rastrainer_simulator.doctor.finding import Finding, Verdict
from rastrainer_simulator.flow import preferences
from rastrainer_simulator.limits_file import read_limits


def check_settings(config: Path) -> Iterator[Finding]:
    """Read each file of the settings that is there."""
    try:
        read_limits(config)
    except InputError as error:
        remedy = "Mend the file, or take it away for the limits by default."
        yield Finding("settings", Verdict.PROBLEM, f"No simulator starts: {error}", remedy)
    readers = {
        preferences.FILE_NAME: preferences.read_preferences,
        bindings_file.FILE_NAME: bindings_file.read_bindings,
    }
    for name, read in readers.items():
        try:
            if (config / name).exists():
                read(config / name)
        except InputError as error:
            remedy = "Choose them again in the trainee's menu, which writes the file anew."
            yield Finding(
                "settings", Verdict.WARNING, f"Those by default are used: {error}", remedy
            )
