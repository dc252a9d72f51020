"""One set of checks for commands, records and files: what they accept, and their sentences."""

import json

import pytest

from rastrainer import json_checks
from rastrainer.errors import InputError
from rastrainer.files.json_fields import read_fields
from rastrainer.json_checks import Argument, accepted, checked_keys, is_number


@pytest.mark.parametrize(
    ("check", "value", "words"),
    [
        pytest.param(json_checks.text(3), "abcd", "printable text of 1 to 3", id="long text"),
        pytest.param(json_checks.pseudonym(), " a", "without a space at its", id="space"),
        pytest.param(json_checks.number(0, 1, "s"), True, "a number from 0 to 1 s", id="true"),
        pytest.param(json_checks.number(0, 1), float("nan"), "a number from 0 to 1", id="nan"),
        pytest.param(json_checks.whole_number(0, 9), 1.0, "a whole number from 0", id="float"),
        pytest.param(json_checks.numbers(2, 5), [1, 6], "a list of 2 numbers within ±5", id="far"),
        pytest.param(json_checks.texts(1, 2), [], "a list of 1 to 2 texts", id="empty list"),
        pytest.param(json_checks.texts(1, 2), ["a", "a"], "without duplicates", id="twice"),
        pytest.param(json_checks.texts(1, 2, ("a",)), ["b"], "a list of some of a", id="choice"),
        pytest.param(json_checks.yes_or_no, 1, "true or false", id="one"),
    ],
)
def test_a_check_refuses_with_the_words_that_follow_must_be(check, value, words):
    with pytest.raises(InputError, match=f"^The value must be .*{words}"):
        accepted(check, value, "The value")


def test_a_missing_required_key_is_named():
    keys = {"a": Argument(json_checks.yes_or_no), "b": Argument(json_checks.text(), "usual")}
    assert checked_keys({"a": True}, keys, "It") == {"a": True, "b": "usual"}
    with pytest.raises(InputError, match='It needs the key "a"'):
        checked_keys({}, keys, "It")


def test_true_and_false_are_no_numbers():
    assert [is_number(value) for value in (1, 0.5, True, "1")] == [True, True, False, False]


def test_a_file_may_write_a_whole_number_with_a_point(tmp_path):
    (tmp_path / "a.json").write_text(json.dumps({"count": 3.0, "half": 2.5}), encoding="utf-8")
    fields = read_fields(tmp_path / "a.json")
    assert fields.whole_number("count", 0, 9) == 3
    with pytest.raises(InputError, match="the field half must be a whole number from 0 to 9"):
        fields.whole_number("half", 0, 9)
