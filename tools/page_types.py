"""Write the page's TypeScript types of messages, and the constants that it draws with.

They come from the dataclasses in `presentation/messages.py` and `board/board_messages.py`, and from
`presentation/look.py`. With `--check`, report whether the written file is up to date instead.
"""

import json
import sys
from collections.abc import Mapping
from dataclasses import is_dataclass
from enum import Enum
from pathlib import Path
from types import NoneType
from typing import Annotated, Any, Literal, get_args, get_origin

from rastrainer.json_records import record_fields
from rastrainer_simulator.board import board_messages
from rastrainer_simulator.presentation import look, messages
from rastrainer_simulator.vectors import Vector

FILE = Path(__file__).parents[1] / "RASTrainerSimulatorServer" / "web" / "src" / "generated.ts"
HEAD = """/**
 * What page and simulator share, written by tools/page_types.py: do not edit.
 * docs/views.md explains the messages, presentation/look.py the constants.
 */"""
UNIONS = {kind.__name__: kind.__subclasses__() for kind in (messages.News, messages.ViewInput)}
ROOTS = (
    *(kind for kinds in UNIONS.values() for kind in kinds),
    board_messages.TilesNews,
    board_messages.ClassNews,
    messages.InstructorOrder,
    messages.ViewRole,
)
LIMITS = ("SUBPROTOCOL", "MAX_KEY_TEXT", "MAX_ITEM_TEXT", "MAX_DEVICE_TEXT", "MAX_FRAMES")
ALIASES = {Vector: "Vector", messages.Pose: "Pose"}
LONGEST_LINE = 100
PLAIN = {str: "string", bool: "boolean", int: "number", float: "number"}


class PageTypes:
    """TypeScript declarations of Python types, each after those that it needs."""

    def __init__(self) -> None:
        self.declarations: dict[Any, str] = {}

    def of(self, hint: Any) -> str:
        """Return the TypeScript type of an annotation."""
        origin, parts = get_origin(hint), get_args(hint)
        if hint in PLAIN:
            return PLAIN[hint]
        if hint in ALIASES or is_dataclass(hint) or _is_enum(hint):
            self._declare(hint)
            return ALIASES.get(hint) or hint.__name__
        if origin is Annotated:
            return self.of(parts[0])
        if origin is Literal:
            return " | ".join(map(json.dumps, parts))
        if NoneType in parts:
            (kind,) = (part for part in parts if part is not NoneType)
            return f"{self.of(kind)} | null"
        if origin is tuple:
            return self._list(parts)
        if origin is not None and issubclass(origin, Mapping):
            return f"Readonly<Record<{self.of(parts[0])}, {self.of(parts[1])}>>"
        raise TypeError(f"The page knows no type for {hint}.")

    def _list(self, parts: tuple[Any, ...]) -> str:
        if parts[-1] is not ...:
            return f"readonly [{', '.join(map(self.of, parts))}]"
        item = self.of(parts[0])
        return f"readonly ({item})[]" if " " in item else f"readonly {item}[]"

    def _declare(self, hint: Any) -> None:
        if hint in self.declarations:
            return
        if hint in ALIASES:
            text = f"export type {ALIASES[hint]} = {self._list(get_args(hint))};"
        elif _is_enum(hint):
            values = " | ".join(json.dumps(each.value) for each in hint)
            text = f"{_comment(hint)}\nexport type {hint.__name__} = {values};"
        else:
            keys = [f"readonly {each.key}: {self.of(each.hint)};" for each in record_fields(hint)]
            if issubclass(hint, messages.ViewMessage):
                keys.insert(0, f'readonly type: "{hint.type}";')
            head = f"export interface {hint.__name__} {{"
            line = " ".join((head, *keys, "}"))
            lines = "\n".join((head, *(f"  {key}" for key in keys), "}"))
            text = f"{_comment(hint)}\n{line if len(line) <= LONGEST_LINE else lines}"
        self.declarations[hint] = text


def _is_enum(hint: Any) -> bool:
    return isinstance(hint, type) and issubclass(hint, Enum)


def _comment(kind: type) -> str:
    return f"/** {(kind.__doc__ or '').partition(chr(10))[0]} */"


def _constant(name: str, value: Any) -> str:
    ending = " as const" if isinstance(value, (Mapping, tuple, frozenset)) else ""
    text = json.dumps(value, default=lambda it: dict(it) if isinstance(it, Mapping) else list(it))
    return f"export const {name} = {text}{ending};"


def page_types() -> str:
    """Return the content of the file."""
    types = PageTypes()
    for root in ROOTS:
        types.of(root)
    unions = [
        f"export type {name} =\n  | " + "\n  | ".join(map(types.of, kinds)) + ";"
        for name, kinds in UNIONS.items()
    ]
    constants = {name: getattr(messages, name) for name in LIMITS}
    constants["BOARD_SUBPROTOCOL"] = board_messages.BOARD_SUBPROTOCOL
    constants |= {name: value for name, value in vars(look).items() if name.isupper()}
    lines = "\n".join(_constant(name, value) for name, value in constants.items())
    return "\n\n".join([HEAD, *types.declarations.values(), *unions, lines, ""])


def main() -> None:
    """Write the file, or with `--check` fail if it is old."""
    content = page_types()
    is_current = FILE.exists() and FILE.read_text(encoding="utf-8") == content
    if sys.argv[1:] == ["--check"]:
        if not is_current:
            sys.exit(f"{FILE.name} is older than the messages: run make page.")
    elif not is_current:
        FILE.write_text(content, encoding="utf-8")


if __name__ == "__main__":
    main()
