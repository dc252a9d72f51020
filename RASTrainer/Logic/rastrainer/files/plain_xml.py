"""XML that nobody has checked yet: no document type, no entities, not too deep and not too much."""

from __future__ import annotations

import re
from typing import Any
from xml.parsers import expat

from rastrainer.errors import InputError
from rastrainer.files.reading import decode_text

MOST_ELEMENTS = 20_000
DEEPEST = 64

_DECLARATION = re.compile(r"\s*<\?xml\s[^>]*\?>")


def plain_xml(content: bytes, what: str) -> str:
    """Return XML as it can be given to any parser, without its declaration.

    The declaration goes because it may name an encoding in which the rest reads differently.
    `what` begins the sentence of an error, such as "The URDF robot.urdf".

    Raises:
        InputError: not UTF-8, not well-formed, with a document type or entities (they could expand
            without end, or name other files), too deeply nested, or too many elements.
    """
    text = decode_text(content, what)
    declaration = _DECLARATION.match(text)
    body = text[declaration.end() :] if declaration else text
    try:
        _Check(what).parse(body.encode())
    except expat.ExpatError as error:
        raise InputError(f"{what} is not well-formed XML: {error}.") from None
    return body


class _Check:
    """Looks at every element as it comes, and stops at the first that is one too many."""

    def __init__(self, what: str) -> None:
        self._what = what
        self._elements = 0
        self._depth = 0

    def parse(self, body: bytes) -> None:
        parser = expat.ParserCreate("utf-8")
        parser.StartElementHandler = self._begin
        parser.EndElementHandler = self._end
        parser.StartDoctypeDeclHandler = self._refuse_type
        parser.Parse(body, True)

    def _begin(self, _name: str, _attributes: Any) -> None:
        self._elements += 1
        self._depth += 1
        if self._elements > MOST_ELEMENTS:
            raise InputError(f"{self._what} has more than {MOST_ELEMENTS} elements.")
        if self._depth > DEEPEST:
            raise InputError(f"{self._what} nests its elements more than {DEEPEST} deep.")

    def _end(self, _name: str) -> None:
        self._depth -= 1

    def _refuse_type(self, *_declaration: Any) -> None:
        raise InputError(f"{self._what} declares a document type or entities; remove them.")
