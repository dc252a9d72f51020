"""Feedback on a trial: score, inaccurate touches and their reasons, advice."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rastrainer.errors import InputError
from rastrainer.motion.trajectory import Touch, Trajectory
from rastrainer.protocol import RegistrationMethod
from rastrainer.registration.registration import register
from rastrainer.registration.target_error import CommonBias
from rastrainer.trial.advice import Reason, advise, touch_findings
from rastrainer.trial.trial_feedback import progress_of, trial_feedback
from rastrainer.trial.trial_row import TrialRow
from Testing.domain.trial.trial_records import gentle_score
from Testing.touched_head import head_points

LABELS = tuple(str(i + 1) for i in range(15))
FIXED = head_points(np.random.default_rng(2))
NORMALS = FIXED / np.linalg.norm(FIXED, axis=1, keepdims=True)
TANGENTS = np.cross(NORMALS, [0.3, 0.2, 0.9])
TANGENTS /= np.linalg.norm(TANGENTS, axis=1, keepdims=True)


def registered(errors, seed=0):
    """A registration of touches with (15, 3) errors and a little noise."""
    noise = np.random.default_rng(seed).normal(0, 0.15, (15, 3))
    return register(FIXED + errors + noise, FIXED, labels=LABELS)


EVEN = touch_findings(registered(np.zeros((15, 3))), NORMALS)


def recording(hurried=(), shaking=()):
    """Two seconds per point, with the tip at rest in the second half."""
    rng = np.random.default_rng(1)
    times = np.arange(0, 30, 0.02)
    tip = np.zeros((len(times), 3))
    touches, positions = [], 100.0 * rng.normal(size=(15, 3))
    for i in range(15):
        part = slice(i * 100, (i + 1) * 100)
        tip[part] = positions[i]
        came = 97 if i in hurried else 50
        tip[part.start : part.start + came] += [60.0, 0, 0]
        if i in shaking:
            tip[part.start + came : part.stop] += rng.normal(0, 0.7, (100 - came, 3))
        touches.append(Touch(LABELS[i], tuple(positions[i]), (part.stop - 1) * 0.02))
    return Trajectory(times, tip, np.full(len(times), 5.0), tuple(touches))


def test_errors_in_depth_and_along_the_skin_are_distinguished():
    errors = np.zeros((15, 3))
    errors[3] = 4.0 * NORMALS[3]
    errors[9] = 4.0 * TANGENTS[9]
    findings = {f.label: f for f in touch_findings(registered(errors), NORMALS)}
    assert {label for label, f in findings.items() if f.is_outlier} == {"4", "10"}
    assert findings["4"].reasons == (Reason.DEPTH,)
    assert findings["10"].reasons == (Reason.ASIDE,)
    assert "mm above the skin" in findings["4"].sentence
    assert "mostly along the skin" in findings["10"].sentence
    assert sum(f.share for f in findings.values()) == pytest.approx(1.0)
    assert findings["4"].depth_mm == pytest.approx(findings["4"].residual_mm, rel=0.05)


def test_hurry_and_shaking_are_found_in_the_recording():
    errors = np.zeros((15, 3))
    errors[[4, 11]] = 4.0 * TANGENTS[[4, 11]]
    findings = touch_findings(registered(errors), NORMALS, recording(hurried=[4], shaking=[11]))
    assert Reason.HURRY in findings[4].reasons
    assert Reason.SHAKING in findings[11].reasons
    assert Reason.HURRY not in findings[11].reasons
    assert findings[7].reasons == ()
    assert findings[11].replay_s == pytest.approx((21.98, 23.98))
    assert findings[4].dwell_s < 0.15 < findings[7].dwell_s


def test_safety_advice_comes_first_then_the_most_rewarding():
    errors = np.zeros((15, 3))
    errors[3] = 6.0 * TANGENTS[3]
    findings = touch_findings(registered(errors), NORMALS)
    motion = {
        "idle_time_s": 4.0,
        "path_efficiency": 0.3,
        "refused_touches": 1,
        "unintended_contacts": 2,
    }
    advice = advise(gentle_score(110.0, 1.2), findings, motion)
    assert len(advice) == 3
    assert advice[0].sentence.key == "contacts"
    assert "2 times" in advice[0].sentence
    assert advice[1].sentence.key.startswith("worst touch")
    assert advice[1].gain > advice[2].gain > 0


BIASES = {
    "to the patient's left": (-1.8, 0.3, 0.0),
    "toward the face": (0.0, 1.7, -0.8),
    "toward the neck": (0.5, 0.5, -1.6),
    "to the patient's left and toward the crown": (-1.4, 0.2, 1.1),
}


@pytest.mark.parametrize("words", BIASES)
def test_the_direction_of_a_common_bias_is_reported(words):
    bias = CommonBias(BIASES[words], p=0.001)
    score = gentle_score(110.0, 0.5, common_bias_mm=bias.length_mm)
    motion = {"idle_time_s": 80.0, "unintended_contacts": 1}
    contacts, *advice = advise(score, EVEN, motion, bias)
    # Beyond its limit, it comes right after safety.
    assert contacts.sentence.key == "contact"
    assert advice[0].sentence.key.endswith("common bias")
    length = f"{bias.length_mm:.1f} mm"
    assert f"On average, the touches are {length} too far {words}, which" in advice[0].sentence


@settings(max_examples=40)
@given(
    st.floats(20, 1000),
    st.floats(0.05, 5),
    st.floats(0, 0.9),
    st.floats(0.05, 1.2),
    st.integers(0, 20),
)
def test_advice_never_promises_more_than_the_whole_score(time, error, idle, efficiency, refused):
    score = gentle_score(time, error)
    motion = {"idle_time_s": idle * time, "path_efficiency": efficiency, "refused_touches": refused}
    advice = advise(score, EVEN, motion)
    assert len(advice) <= 3
    for one in advice:
        assert 0 <= one.gain <= 100 - score.score


def past(number, score, mode="desktop", acceptable=True):
    return TrialRow(
        *("T-001", mode, "task-1", number),
        values={"score": score},
        trial_id=str(number),
        acceptable=acceptable,
    )


def test_progress_reports_best_score_pass_mark_and_competence():
    history = [past(i, 40.0 + i) for i in range(12)]
    progress = progress_of(history, history[-1].trial_id, pass_mark=45.0)
    assert progress.sentences[0].endswith("It is your best so far.")
    assert progress.sentences[1] == "Passed: the mark is 45."
    early = progress_of(history, history[2].trial_id, pass_mark=45.0)
    assert early.sentences[0].values["trials"] == 2
    assert early.sentences[1] == "Not passed yet: 3.0 short of the mark of 45."
    assert early.sentences[2].startswith(
        "0 % of the way to demonstrated competence (LC-CUSUM; trials so far: 3)"
    )


def test_a_trial_is_compared_with_trials_of_its_method_alone_finished_or_aborted():
    by_surface = RegistrationMethod.SURFACE
    first = [replace(past(i, 99.0), method=by_surface) for i in range(20)]
    first += [replace(past(30 + i, 0.0), method=by_surface, is_aborted=True) for i in range(3)]
    history = [*first, *(past(20 + i, 50.0 + i) for i in range(2))]
    once = progress_of(history, history[-2].trial_id, pass_mark=60.0)
    assert once.sentences[0].key == "first by this method"
    assert (once.sentences[2].key, once.sentences[2].values["trials"]) == ("not competent", 1)
    twice = progress_of(history, history[-1].trial_id, pass_mark=60.0)
    assert twice.sentences[0].startswith("Your score is 1 above that of your last trial")


def test_without_a_pass_mark_for_its_method_a_trial_neither_passes_nor_fails():
    history = [past(1, 50.0), past(2, 99.0)]
    progress = progress_of(history, history[1].trial_id, None)
    assert (progress.pass_mark, len(progress.sentences)) == (None, 2)
    assert progress.sentences[1].startswith("Neither passed nor failed: the pass mark")
    bad = replace(history[1], acceptable=False)
    for mark in (None, 10.0):
        assert progress_of([bad], bad.trial_id, mark).sentences[1].key == "unacceptable"
    with pytest.raises(InputError, match="scored trial of the trainee's own"):
        progress_of([], bad.trial_id, 10.0)


def test_competence_is_shown_by_passed_trials_in_the_same_mode():
    history = [past(i, 80.0) for i in range(20)]
    progress = progress_of(history, history[-1].trial_id, pass_mark=60.0)
    assert progress.sentences[2].key == "competent"
    assert progress.sentences[2].values["risk"] <= 5.0
    hundred = [past(i, 80.0) for i in range(100)]
    progress = progress_of(hundred, hundred[-1].trial_id, pass_mark=60.0)
    assert progress.sentences[2].values["risk"] > 5.0
    other = [past(i, 80.0, mode="hmd") for i in range(19)] + [past(19, 80.0)]
    assert progress_of(other, other[-1].trial_id, 60.0).sentences[2].key == "not competent"


def test_the_feedback_says_score_worst_touch_advice_and_progress_in_this_order():
    errors = np.zeros((15, 3))
    errors[3] = 5.0 * NORMALS[3]
    history = [past(1, 50.0), past(2, 60.0)]
    score, motion = gentle_score(150.0, 2.5), {"idle_time_s": 40.0}
    feedback = trial_feedback(registered(errors), NORMALS, motion, recording())
    advice, progress = advise(score, feedback.touches, motion), progress_of(history, "2", 55.0)
    feedback = replace(feedback, score=score, advice=advice, progress=progress)
    sentences = feedback.sentences
    begun = ["Score ", "Time: ", "Accuracy: 2.50 mm", "Safety: ", "Point 4 was", "1. "]
    assert [text[: len(words)] for text, words in zip(sentences, begun, strict=False)] == begun
    assert "more than 1.5 mm of error is not acceptable" in sentences[2]
    assert sentences[-len(progress.sentences) :] == tuple(progress.sentences)
    short = (feedback.worst.sentence, advice[0].sentence, progress.sentences[0])
    assert tuple(feedback.short_sentences) == short
