"""Control charts of trainees, against simulation."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.trial.lc_cusum import (
    FALSE_DISCOVERY,
    lc_cusum,
    lc_cusum_limit,
    log_likelihood_ratios,
    signal_probability,
)


@pytest.mark.parametrize("rates", [(0.4, 0.2), (0.0, 0.2), (0.2, 1.0), (float("nan"), 0.5)])
def test_invalid_rates_are_refused(rates):
    with pytest.raises(InputError, match="acceptable failure rate above 0"):
        lc_cusum([True], *rates, 1.0)


def test_the_probability_of_a_signal_is_that_of_simulated_trainees():
    rng = np.random.default_rng(0)
    failures = rng.random((4000, 25)) < 0.4
    signaled = [lc_cusum(row, 0.1, 0.4, 1.25).competent_at is not None for row in failures[:800]]
    exact = signal_probability(0.4, 25, 0.1, 0.4, 1.25)
    assert np.mean(signaled) == pytest.approx(exact, abs=0.05)


def test_the_limit_keeps_the_risk_and_competent_trainees_pass():
    limit = lc_cusum_limit(0.05, 0.4, 20)
    assert signal_probability(0.4, 20, 0.05, 0.4, limit) <= 0.05
    assert signal_probability(0.4, 20, 0.05, 0.4, limit - 1e-3) > 0.05
    assert signal_probability(0.05, 20, 0.05, 0.4, limit) > 0.9
    assert lc_cusum([True, True, *[False] * 12], 0.05, 0.4, limit).competent_at is not None
    with pytest.raises(InputError, match="3 trials cannot show competence"):
        lc_cusum_limit(0.05, 0.4, 3)


def test_fewer_than_eleven_trials_cannot_show_competence_at_the_accepted_risk():
    limit = lc_cusum_limit(0.05, 0.4, 30)
    assert lc_cusum([False] * 10, 0.05, 0.4, limit).competent_at is None
    assert lc_cusum([False] * 11, 0.05, 0.4, limit).competent_at == 11
    success, _failure = log_likelihood_ratios(0.05, 0.4)
    chances = [signal_probability(0.4, 30, 0.05, 0.4, count * success) for count in (10, 11)]
    assert chances[0] > FALSE_DISCOVERY > chances[1]
