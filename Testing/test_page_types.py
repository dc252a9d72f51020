"""The page has the simulator's types and constants."""

from __future__ import annotations

import pytest

from tools.page_types import FILE, PageTypes, page_types


def test_the_page_has_the_messages_and_constants_of_the_simulator():
    assert FILE.read_text(encoding="utf-8") == page_types(), "run make page"


def test_a_type_that_json_does_not_have_is_refused():
    assert PageTypes().of(tuple[str | None, ...]) == "readonly (string | null)[]"
    with pytest.raises(TypeError, match="knows no type"):
        PageTypes().of(complex)
