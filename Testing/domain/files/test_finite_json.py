"""JSON from anywhere: how deep it may be is ours to say, and not the interpreter's."""

from __future__ import annotations

import pytest

from rastrainer.finite_json import DEEPEST, MESSAGE_VALUES, decode_finite_json, decode_message


def nested(levels: int, opening: str, closing: str) -> str:
    return opening * levels + "1" + closing * levels


@pytest.mark.parametrize(("opening", "closing"), [("[", "]"), ('{"a":', "}"), ('[{"a":[', "]}]")])
def test_json_up_to_64_levels_is_taken_and_one_level_more_refused(opening, closing):
    times, rest = divmod(DEEPEST, len(closing))
    text = "[" * rest + nested(times, opening, closing) + "]" * rest
    assert decode_finite_json(text) is not None
    with pytest.raises(ValueError, match="too deeply nested"):
        decode_finite_json(f"[{text}]")


@pytest.mark.parametrize("levels", [1000, 100_000])
def test_json_beyond_what_the_interpreter_takes_is_refused_in_the_same_words(levels):
    with pytest.raises(ValueError, match="too deeply nested"):
        decode_finite_json(nested(levels, "[", "]"))


def test_what_is_wide_or_a_text_of_brackets_is_not_deep():
    assert len(decode_finite_json("[" + ",".join(["[{}]"] * 1000) + "]")) == 1000
    assert decode_finite_json('"' + "[" * 1000 + '"') == "[" * 1000


def test_a_message_of_very_many_values_is_refused_before_it_is_decoded():
    most = f"[{','.join('1' * MESSAGE_VALUES)}]"
    assert len(decode_message(most)) == MESSAGE_VALUES
    with pytest.raises(ValueError, match="too many values"):
        decode_message(most.replace("1", "1,1", 1))


@pytest.mark.parametrize("number", ["NaN", "Infinity", "-Infinity", "1e999"])
def test_a_number_that_is_not_finite_is_refused(number):
    with pytest.raises(ValueError, match=number.lstrip("-")):
        decode_finite_json(f"[{number}]")


@pytest.mark.parametrize(
    "text",
    ["-1e999", "[1,[2,-1e999]]", '{"a":{"b":[-1e999,1]}}', f"[-1e999,{'9' * 400}.0]"],
    ids=["alone", "in lists", "in objects", "before another"],
)
def test_a_number_too_large_is_refused_by_its_digits_wherever_it_stands(text):
    with pytest.raises(ValueError, match=r"^-1e999 is too large a number$"):
        decode_finite_json(text)


def test_whole_numbers_of_any_length_and_what_rounds_to_nothing_are_finite():
    assert decode_finite_json(f"[1{'0' * 400},1e-999,-0.0,1e308]") == [10**400, 0.0, -0.0, 1e308]
