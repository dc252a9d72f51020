"""The page of the result: what it says of a score, and how a trial beyond a limit looks."""

from __future__ import annotations

import pytest

from rastrainer_simulator.flow.flow_presenter import FlowPresenter
from rastrainer_simulator.flow.session.preferences import Preferences
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.presentation.screen import Tone
from rastrainer_simulator.texts.texts import LANGUAGES, Texts
from Testing.simulator.flow.conftest import Outside, put_back
from Testing.simulator.flow.trainee import RATE_HZ, Keys, Trainee

REGISTRATION = {
    "matrix": (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0),
    "freMm": 1.2,
    "expectedTreMm": 0.8,
}
GENERAL = {
    "key": "unacceptable",
    "values": {},
    "text": "Not passed: the true error in the brain, or the contact with the head, is beyond what "
    "is acceptable.",
}


@pytest.fixture(scope="module")
def registered(shared, tmp_path_factory):
    """Return a trainee who waits for the score of a trial that was played."""
    folder = tmp_path_factory.mktemp("played")
    put_back(shared)
    with ControlLoop(shared, folder / "records", rate_hz=RATE_HZ, speed=None) as loop:
        presenter = FlowPresenter(loop, Outside(folder).services, DEFAULT_BINDINGS, Preferences())
        trainee = Trainee(loop, presenter, Keys)
        trainee.until_menu("start")
        trainee.start("task-1")
        trainee.play("task-1")
        trial = trainee.register()
        assert trainee.submit("SubmitRegistration", trialId=trial, **REGISTRATION).ok
        yield trainee
        trainee.close()
        presenter.close()


@pytest.fixture
def result_of(registered):
    """Have the trial scored, again, with these details, and return the menu of the result."""

    def show(score=95.0, **details):
        trial = registered.state.training.trial_id
        assert registered.submit("TrialScored", trialId=trial, score=score, details=details).ok
        result = lambda: registered.state.training.result  # noqa: E731
        registered.until(lambda: result() is not None and result().details == details, "the score")
        registered.until_menu("result")
        registered.step(50)
        return registered.menu

    return show


def facts_of(menu):
    return {fact.label: fact for fact in menu.facts}


def test_the_true_error_in_the_brain_is_shown_beside_the_others(result_of):
    menu = result_of(regionTreMm=0.73, isAccurate=True, isSafe=True, passMark=70.0)
    assert [fact.label for fact in menu.facts][:5] == [
        "Score",
        "Registration error (FRE)",
        "Expected error at the target (TRE)",
        "True error at the target (TRE)",
        "True error in the brain (TRE)",
    ]
    region = facts_of(menu)["True error in the brain (TRE)"]
    assert (region.value, region.tone) == ("0.73 mm", Tone.GOOD)
    score = facts_of(menu)["Score"]
    assert (score.value, score.tone) == ("95 / 100", Tone.GOOD)
    assert not any("acceptable" in sentence for sentence in menu.paragraphs)


def test_the_common_bias_is_shown_with_a_warning_beyond_its_limit(result_of):
    within = facts_of(result_of(commonBiasMm=0.41, isAccurate=True, isUnbiased=True, isSafe=True))
    fact = within["Bias that all touches share"]
    assert (fact.value, fact.tone) == ("0.41 mm", Tone.PLAIN)
    beyond = result_of(commonBiasMm=1.81, isAccurate=True, isUnbiased=False, isSafe=True)
    assert facts_of(beyond)["Bias that all touches share"].tone is Tone.WARNING


@pytest.mark.parametrize(
    ("mark", "tone"), [(70.0, Tone.GOOD), (99.0, Tone.PLAIN), (None, Tone.PLAIN)]
)
def test_a_score_is_shown_as_good_only_where_it_reaches_a_pass_mark(result_of, mark, tone):
    assert facts_of(result_of(passMark=mark))["Score"].tone is tone


def test_a_score_without_the_error_in_the_brain_has_no_line_for_it(result_of):
    assert "True error in the brain (TRE)" not in facts_of(result_of())


@pytest.mark.parametrize(
    ("details", "sentence"),
    [
        pytest.param(
            {"isAccurate": False, "isSafe": True},
            "Not acceptable: an instrument guided by this registration would miss its target.",
            id="inaccurate",
        ),
        pytest.param(
            {"isAccurate": True, "isUnbiased": False, "isSafe": True},
            "Not acceptable: all touches are off in the same direction, by more than the limit.",
            id="biased",
        ),
        pytest.param(
            {"isAccurate": True, "isSafe": False},
            "Not acceptable: the tool rested on the head too long or was pressed in too deeply.",
            id="unsafe",
        ),
    ],
)
def test_a_trial_beyond_a_limit_is_called_not_acceptable_and_nothing_in_it_looks_good(
    result_of, details, sentence
):
    menu = result_of(regionTreMm=1.6, passMark=10.0, feedback=[GENERAL], **details)
    score = facts_of(menu)["Score"]
    assert (score.value, score.tone) == ("95 / 100, not acceptable", Tone.WARNING)
    assert not any(fact.tone is Tone.GOOD for fact in menu.facts)
    assert menu.paragraphs[0].startswith(sentence)
    # The reason takes the place of the sentence that has none.
    assert GENERAL["text"] not in menu.paragraphs


def test_an_error_in_the_brain_beyond_the_limit_is_a_warning_however_small_it_looks(result_of):
    menu = result_of(regionTreMm=1.6, isAccurate=False, isSafe=True)
    assert facts_of(menu)["True error in the brain (TRE)"].tone is Tone.WARNING


def test_the_page_is_shown_in_german_too():
    texts = Texts(LANGUAGES["de"])
    for key in (
        "region tre",
        "unacceptable score",
        "not accurate",
        "not safe",
        "not unbiased",
        "common bias",
    ):
        assert f"result.{key}" in LANGUAGES["de"]
    assert texts.say("result.unacceptable score", score=12.4) == "12 / 100, nicht zulässig"
