"""Decoding JSON with limits, and the checks of commands, records and files."""

from __future__ import annotations

import pytest

from rastrainer.errors import InputError
from rastrainer.json_checks import (
    MAX_DEPTH,
    MAX_MESSAGE_VALUES,
    decode_finite_json,
    decode_message_object,
)


def nested(levels: int, opening: str, closing: str) -> str:
    return opening * levels + "1" + closing * levels


@pytest.mark.parametrize(("opening", "closing"), [("[", "]"), ('{"a":', "}"), ('[{"a":[', "]}]")])
def test_json_of_64_levels_is_accepted_and_of_65_refused(opening, closing):
    times, rest = divmod(MAX_DEPTH, len(closing))
    text = "[" * rest + nested(times, opening, closing) + "]" * rest
    assert decode_finite_json(text) is not None
    with pytest.raises(ValueError, match="too deeply nested"):
        decode_finite_json(f"[{text}]")


@pytest.mark.parametrize("levels", [1000, 100_000])
def test_json_too_deep_for_the_interpreter_is_refused_with_the_same_message(levels):
    with pytest.raises(ValueError, match="too deeply nested"):
        decode_finite_json(nested(levels, "[", "]"))


def test_wide_json_and_text_of_brackets_are_not_deep():
    assert len(decode_finite_json("[" + ",".join(["[{}]"] * 1000) + "]")) == 1000
    assert decode_finite_json('"' + "[" * 1000 + '"') == "[" * 1000


def test_a_message_with_too_many_values_is_refused_before_it_is_decoded():
    most = f'{{"values":[{",".join("1" * MAX_MESSAGE_VALUES)}]}}'
    assert len(decode_message_object(most, "It")["values"]) == MAX_MESSAGE_VALUES
    with pytest.raises(InputError, match=f"at most {MAX_MESSAGE_VALUES} values"):
        decode_message_object(most.replace("1", "1,1", 1), "It")


@pytest.mark.parametrize(
    "text", ["[NaN]", "[-Infinity]", "-1e999", "[1,[2,-1e999]]", '{"a":{"b":[-1e999,1]}}']
)
def test_a_number_that_is_not_finite_is_refused_anywhere(text):
    with pytest.raises(ValueError, match=r"not a number|too large"):
        decode_finite_json(text)


def test_integers_of_any_length_and_underflowing_numbers_are_finite():
    assert decode_finite_json(f"[1{'0' * 400},1e-999,-0.0,1e308]") == [10**400, 0.0, -0.0, 1e308]
