"""Makes the table of commands in docs/openigtlink.md of the entries in `rastrainer.commands`."""

from __future__ import annotations

import re
from pathlib import Path

from rastrainer.commands import COMMANDS, CommandEntry
from rastrainer.errors import InputError
from rastrainer.json_records import RecordField, record_fields

PAGE = Path(__file__).parents[1] / "docs" / "openigtlink.md"
HEAD = "| command | what it does | arguments | answer |\n|---|---|---|---|\n"
TABLE = re.compile(re.escape(HEAD) + r"(?:\|.*\n)*")


def page() -> str:
    rows = "".join(map(row, COMMANDS.values()))
    return TABLE.sub(lambda _: HEAD + rows, PAGE.read_text(encoding="utf-8"))


def row(command: CommandEntry) -> str:
    arguments = ", ".join(argument(each) for each in record_fields(command.arguments))
    return f"| `{command}` | {command.effect} | {arguments} | {command.answer} |\n"


def argument(field: RecordField) -> str:
    """Return an argument, in italics if it is optional, with its allowed values and its default."""
    name, default = f"`{field.key}`", None
    words = [must_be(field)]
    words += [mark for mark in getattr(field.hint, "__metadata__", ()) if isinstance(mark, str)]
    if field.default is not None:
        name, default = f"*{name}*", field.default()
    if isinstance(default, bool):
        words.append(f"default {default}".lower())
    elif default:
        words.append(f"default {getattr(default, 'value', default)}".removesuffix(".0"))
    return f"{name} ({'; '.join(words)})"


def must_be(field: RecordField) -> str:
    """Return the words by which a value is refused that no argument accepts."""
    try:
        field.read(object(), "", True)
    except InputError as error:
        return str(error).removeprefix(" must be ").removesuffix(".")
    raise AssertionError(f"{field.key} accepts anything")


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
