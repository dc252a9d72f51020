"""Write the reference pages in docs: commands, lines of a journal, messages of views.

They list the records of `rastrainer.commands`, `rastrainer.journal.entries` and
`rastrainer_simulator.presentation.messages`, each with its docstring and its keys.
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Container, Iterator, Mapping
from dataclasses import is_dataclass
from pathlib import Path
from types import NoneType
from typing import Any, get_args

from rastrainer.commands import COMMANDS
from rastrainer.errors import InputError
from rastrainer.journal.entries import KINDS, Stamp
from rastrainer.json_records import RecordField, camel_case, record_fields
from rastrainer_simulator.board.board_messages import ClassNews
from rastrainer_simulator.presentation.messages import News, SeatNews, ViewInput

ATTRIBUTE = re.compile(r"^ *(\w+): (.*)$", re.MULTILINE)
FIELD_NAME = re.compile(r"`([a-z]+(?:_[a-z]+)+)`")
HUGE_LIMIT = re.compile(r" (?:from \S+ to|within) ±?(?:\d{6,}|\d+e\+\d+)\b")
FOLDER = Path(__file__).parents[1] / "docs"
MADE = "Keys in italics may be missing. `tools/reference_pages.py` writes this page.\n"
COMMANDS_HEAD = f"""# Commands over OpenIGTLink

Which commands does the simulator take, with which arguments?
[OpenIGTLink](openigtlink.md#commands) says how a command is sent and answered. {MADE}"""
JOURNAL_HEAD = f"""# Lines of a journal

Which kinds of lines does a [journal](trial-journal.md) have, with which keys? {MADE}"""
MESSAGES_HEAD = f"""# Messages of views

Which messages do the simulator and its [views](views.md) exchange? Headings are their `type`.
{MADE}"""


def pages() -> dict[str, str]:
    """Return the pages by their file names."""
    return {
        "commands.md": COMMANDS_HEAD + "".join(_commands()),
        "journal-lines.md": JOURNAL_HEAD + "".join(_journal_lines()),
        "view-messages.md": MESSAGES_HEAD + "".join(_messages()),
    }


def _commands() -> Iterator[str]:
    for name, command in COMMANDS.items():
        answer = f" Answer: {command.answer}." if command.answer else ""
        yield f"\n## {name}\n\n{command.effect}{answer}\n{_keys(command.arguments)}"


def _journal_lines() -> Iterator[str]:
    yield f"\n## Every line\n{_record(Stamp)}"
    for kind, entry in sorted(KINDS.items()):
        yield f"\n## {kind}\n{_record(entry)}"


def _messages() -> Iterator[str]:
    for title, kinds in (
        ("From the simulator", News.__subclasses__()),
        ("To the simulator", ViewInput.__subclasses__()),
        ("Boards", [SeatNews, ClassNews]),
    ):
        yield f"\n## {title}\n"
        for kind in kinds:
            yield f"\n### {getattr(kind, 'type', 'class')}\n{_record(kind)}"


def _record(record: type) -> str:
    """Return the docstring of a record and its keys; records of another kind are named once."""
    about, _, attributes = (inspect.getdoc(record) or "").partition("\n\nAttributes:\n")
    meanings = dict(ATTRIBUTE.findall(" ".join(attributes.split("\n        ")) + "\n"))
    (base,) = record.__bases__[:1]
    if (kind := getattr(base, "kind", None)) in KINDS:
        about += f" It has the keys of [{kind}](#{kind}), and those below."
        known = {each.name for each in record_fields(base)}
    else:
        known = set()
    said = FIELD_NAME.sub(lambda name: f"`{camel_case(name[1])}`", " ".join(about.split()))
    return f"\n{said}\n{_keys(record, meanings, known)}"


def _keys(record: Any, meanings: Mapping[str, str] = {}, known: Container[str] = ()) -> str:
    fields = [each for each in record_fields(record) if each.name not in known]
    lines = [f"- {_key(each, meanings.get(each.name, ''))}\n" for each in fields]
    return "".join(["\n", *lines]) if lines else ""


def _key(field: RecordField, meaning: str) -> str:
    """Return a key, in italics if it may be missing, with its allowed values and its default."""
    name, default = f"`{field.key}`", None
    words = [_must_be(field)]
    if NoneType in get_args(field.hint) and field.default is None:
        words.append("or null")
    words += [mark for mark in getattr(field.hint, "__metadata__", ()) if isinstance(mark, str)]
    words += [meaning.strip().removesuffix(".")] if meaning else []
    if field.default is not None:
        name, default = f"*{name}*", field.default()
    if isinstance(default, bool):
        words.append(f"default {default}".lower())
    elif isinstance(default, (str, int, float)) and default:
        words.append(f"default {getattr(default, 'value', default)}".removesuffix(".0"))
    return f"{name}: {'; '.join(words)}"


def _must_be(field: RecordField) -> str:
    """Return the words by which a value is refused that no field accepts.

    A limit that only wards off nonsense is left out.
    """
    hint, is_list = field.hint, False
    while not isinstance(hint, type) and get_args(hint):
        is_list |= Ellipsis in get_args(hint)
        hint = next(part for part in get_args(hint) if part is not NoneType)
    if is_dataclass(hint):
        keys = ", ".join(f"`{each.key}`" for each in record_fields(hint))
        return f"a list of objects of {keys}" if is_list else f"an object of {keys}"
    try:
        field.read(object(), "", True)
    except InputError as error:
        words = str(error).removeprefix(" must be ").removesuffix(".")
        return HUGE_LIMIT.sub(",", words).removesuffix(",").replace("a text", "text")
    raise AssertionError(f"{field.key} accepts anything")


if __name__ == "__main__":
    for name, page in pages().items():
        (FOLDER / name).write_text(page, encoding="utf-8")
