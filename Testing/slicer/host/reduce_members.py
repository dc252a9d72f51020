"""Make `slicer_members.json` from the full measurement: `python -m … full.json`.

The full measurement was made in Slicer 5.13 by listing each class's meta-object and `dir()`. The
reduced one keeps whole classes: those that a module of ours may want.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

from Testing.slicer.host.offered import OFFERED

TARGET = Path(__file__).with_name("slicer_members.json")
APPLICATION = ("slicer.app", "slicer.util", "slicer.app.layoutManager()")


def reduced(full: dict) -> dict:
    """Return the part of the full measurement that the host needs."""
    facts = {"about": full["about"]}
    for module, names in OFFERED.items():
        facts[module] = {name: full[module][name] for name in names}
    return facts | {name: full[name] for name in APPLICATION}


def text_of(facts: dict) -> str:
    """Return JSON with one line a class, so that a change can be read."""
    lines = []
    for key, value in facts.items():
        if isinstance(value, dict):
            classes = (f"  {json.dumps(name)}: {json.dumps(value[name])}" for name in value)
            lines.append(f" {json.dumps(key)}: {{\n" + ",\n".join(classes) + "\n }")
        else:
            lines.append(f" {json.dumps(key)}: {json.dumps(value)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


if __name__ == "__main__":
    TARGET.write_text(text_of(reduced(json.loads(Path(sys.argv[1]).read_text()))))
