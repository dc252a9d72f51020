"""The order in which fiducials that somebody placed by hand are touched."""

import pytest

from rastrainer.errors import InputError
from rastrainer.scenario.tasks import touch_order


@pytest.mark.parametrize(
    ("labels", "order"),
    [
        pytest.param([str(n) for n in range(1, 16)], list(range(15)), id="numbers"),
        pytest.param([str(n) for n in range(15, 0, -1)], list(range(14, -1, -1)), id="backward"),
        pytest.param([f"F-{n}" for n in range(2, 17)], list(range(15)), id="Slicer's, one deleted"),
        pytest.param([""] * 15, list(range(15)), id="no labels"),
        pytest.param(["left", "ear", *["nose"] * 13], list(range(15)), id="names alone"),
    ],
)
def test_the_numbers_of_the_labels_are_the_order_else_it_is_the_lists(labels, order):
    assert touch_order(labels) == order


@pytest.mark.parametrize(
    ("labels", "sentence"),
    [
        pytest.param([str(n) for n in range(1, 15)], "has 14 fiducials", id="fourteen"),
        pytest.param([str(n) for n in range(1, 17)], "has 16 fiducials", id="sixteen"),
        pytest.param(["1", *[str(n) for n in range(1, 15)]], "two the same", id="one twice"),
        pytest.param(["nose", *[str(n) for n in range(2, 16)]], "no number", id="one without"),
    ],
)
def test_labels_that_are_no_order_are_refused_with_a_sentence(labels, sentence):
    with pytest.raises(InputError, match=sentence) as caught:
        touch_order(labels)
    assert "\n" not in str(caught.value)
