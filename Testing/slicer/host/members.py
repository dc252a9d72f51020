"""The members that real Slicer's classes have: what panels may use, and what they may not.

`slicer_members.json` holds what was measured in Slicer 5.13 (Qt 5.15, PythonQt); `reduce_members`
makes it. `unmeasured.py` adds the few classes that the measurement left out.
"""

from __future__ import annotations

import functools
import json
from dataclasses import dataclass
from pathlib import Path

from Testing.slicer.host.unmeasured import EXTRA_MEMBERS, UNMEASURED

FACTS = json.loads((Path(__file__).parent / "slicer_members.json").read_text(encoding="utf-8"))
MODULES = ("qt", "ctk", "qMRML")


@dataclass(frozen=True)
class Members:
    """What one class has: names of properties and methods, and signatures of signals."""

    properties: frozenset[str]
    signals: frozenset[str]
    methods: frozenset[str]

    def signatures(self, signal: str) -> list[str]:
        """Return the signatures of the signal of that name, that with most arguments first."""
        found = [text for text in self.signals if text.partition("(")[0] == signal]
        return sorted(found, key=_argument_count, reverse=True)


def module_of(class_name: str) -> str | None:
    """Return the module that has the class; None where Slicer has no such class."""
    for module in MODULES:
        if class_name in FACTS[module]:
            return module
    return "qt" if class_name in UNMEASURED else None


@functools.cache
def members_of(class_name: str) -> Members:
    """Return what a class has, with what every widget has."""
    if class_name in UNMEASURED:
        base, extra = UNMEASURED[class_name]
        inherited = members_of(base) if base else Members(frozenset(), frozenset(), frozenset())
        return _add(inherited, extra)
    entry = FACTS[module_of(class_name)][class_name]
    own = Members(
        frozenset(entry["properties"]), frozenset(entry["signals"]), frozenset(entry["methods"])
    )
    if entry["widget"] and class_name != "QWidget":
        base = members_of("QWidget")
        own = Members(
            own.properties | base.properties,
            own.signals | base.signals,
            own.methods | base.methods,
        )
    return _add(own, EXTRA_MEMBERS.get(class_name, ""))


def _add(members: Members, names: str) -> Members:
    """Add names: `.x` is a property, `x(…)` a signal, any other a method."""
    properties, signals, methods = set(), set(), set()
    for name in names.split():
        if name.startswith("."):
            properties.add(name[1:])
        elif "(" in name:
            signals.add(name)
        else:
            methods.add(name)
    return Members(
        members.properties | properties, members.signals | signals, members.methods | methods
    )


def _argument_count(signature: str) -> int:
    arguments = signature.partition("(")[2].rstrip(")")
    return arguments.count(",") + 1 if arguments else 0
