"""With which rules a recorded trial is simulated again."""

from rastrainer.protocol import TouchRule
from rastrainer_simulator.record.recorded_setup import setup_of


def header(setup):
    return {**setup.description(), "robot": setup.robot.name}


def test_the_rule_for_touches_is_the_recorded_one(setup):
    told = setup_of(header(setup)).settings.training
    assert told.touch_rule is TouchRule.ON_SKIN


def test_a_journal_older_than_the_rule_is_replayed_by_that_of_the_paper(setup):
    older = header(setup)
    del older["settings"]["training"]["touch_rule"]
    assert setup_of(older).settings.training.touch_rule is TouchRule.WITHIN_RADIUS


def test_a_journal_recorded_before_the_default_head_had_its_volume_is_still_of_it(setup):
    before = "8ea38ba4bfc46979ba0138ec6bce0c89536b8d9f4066b18be7c9018ccf2420aa"
    assert setup.scenario.volume is not None
    assert setup.scenario_sha256 == before
