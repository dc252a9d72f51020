"""Questionnaires are scored as published."""

import pytest

from rastrainer.errors import InputError
from rastrainer.study.protocol.questionnaires import NASA_TLX, SSQ, SUS


def test_sus_scores_brookes_own_example_with_55():
    """Brooke 1996, the filled-in form: 22 points times 2.5."""
    assert SUS.score([5, 4, 2, 1, 2, 3, 2, 4, 5, 2]) == {"sus": 55.0}


def test_raw_tlx_is_the_mean_of_the_six_scales():
    """Hart 2006: the ratings are simply averaged."""
    scores = NASA_TLX.score([30, 15, 60, 40, 30, 40])
    assert scores["tlx_raw"] == pytest.approx(215 / 6)
    assert scores["tlx_temporal"] == 60
    assert NASA_TLX.score([100] * 6)["tlx_raw"] == 100


def test_performance_runs_from_perfect_to_failure_so_that_failure_is_workload():
    """Hart and Staveland 1988: the ends of this scale are good and poor, not low and high."""
    (item,) = (item for item in NASA_TLX.items if item.anchors)
    assert (item.name, item.anchors) == ("tlx_performance", ("perfect", "failure"))
    place = NASA_TLX.items.index(item)
    perfect, failed = ([50] * place + [end] + [50] * (5 - place) for end in (0, 100))
    assert NASA_TLX.score(failed)["tlx_performance"] == 100
    raised = NASA_TLX.score(failed)["tlx_raw"] - NASA_TLX.score(perfect)["tlx_raw"]
    assert raised == pytest.approx(100 / 6)
    (scale,) = (scale for scale in NASA_TLX.scales if scale.name == "tlx_performance")
    assert (scale.better, scale.title) == (-1, "TLX performance (0 is perfect, 100 is failure)")


def test_ssq_items_belong_to_the_published_scales():
    """Kennedy et al. 1993, by the items' numbers on the form."""
    nausea, oculomotor = {1, 6, 7, 8, 9, 15, 16}, {1, 2, 3, 4, 5, 9, 11}
    disorientation = {5, 8, 10, 11, 12, 13, 14}
    for number in range(1, 17):
        scores = SSQ.score([int(item == number) for item in range(1, 17)])
        on = [scores[f"ssq_{n}"] > 0 for n in ("nausea", "oculomotor", "disorientation")]
        assert on == [number in scale for scale in (nausea, oculomotor, disorientation)]


def test_ssq_has_the_published_maxima():
    """Kennedy et al. 1993: 200.34, 159.18, 292.32 and 235.62 when all symptoms are severe."""
    assert SSQ.score([3] * 16) == {
        "ssq_total": pytest.approx(235.62),
        "ssq_nausea": pytest.approx(200.34),
        "ssq_oculomotor": pytest.approx(159.18),
        "ssq_disorientation": pytest.approx(292.32),
    }


@pytest.mark.parametrize(
    ("answers", "words"),
    [
        ([3] * 9, "needs 10 answers"),
        ([3] * 9 + [6], "sus_10 must be a whole number from 1 to 5"),
        ([3] * 9 + [2.5], "whole number"),
        ([3] * 9 + [None], "leave none out"),
        ({"sus_1": 3}, "needs 10 answers"),
    ],
)
def test_missing_or_invalid_answers_are_refused(answers, words):
    with pytest.raises(InputError, match=words):
        SUS.score(answers)
