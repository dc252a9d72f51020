"""What cannot be concluded, a methods paragraph for a paper, the references and the versions."""

from __future__ import annotations

import platform
from collections.abc import Sequence

import numpy as np

import rastrainer
from rastrainer.number_text import counted, p_text, percent
from rastrainer.protocol import RegistrationMethod
from rastrainer.report import page
from rastrainer.report.comparisons import ModeComparison, compared_method
from rastrainer.statistics.intervals import (
    ALPHA,
    TARGET_POWER,
    detectable_effect,
    scipy_module,
    subjects_needed,
)
from rastrainer.statistics.paired import PairedComparison
from rastrainer.study.outcomes import FILTER, mode_title, task_title
from rastrainer.study.protocol.study_protocol import BALANCED
from rastrainer.study.study_data import StudyData
from rastrainer.trial.score_reference import (
    BELOW_VERTEX_MM,
    REFERENCE_FLE_MM,
    SPACING_MM,
    UNDER_SKIN_MM,
)
from rastrainer.trial.scoring import (
    COMMON_BIAS_LIMIT_MM,
    COMMON_BIAS_POWER,
    CONTACT_LIMIT_S,
    CONTACT_PATH_LIMIT_MM,
    DEPTH_LIMIT_MM,
    HALF_COMMON_BIAS_MM,
    HALF_CONTACT_PATH_MM,
    HALF_CONTACT_S,
    HALF_DEPTH_MM,
    LIMIT_MM,
    LONG_PAUSE_S,
    SCORE_VERSION,
)

FEW_SUBJECTS = 20
"""Below this many subjects the limits are stated without being asked for."""


def limits(data: StudyData, comparisons: Sequence[ModeComparison]) -> str:
    """Return the section."""
    sentences = ["No trainee did two modes: nothing is said about their difference."]
    if comparisons:
        largest = max(comparisons, key=lambda one: (one.result is not None, len(one.trainees)))
        sentences = what_cannot_be_concluded(
            len(largest.trainees), largest.result, largest.order is not None
        )
    sentences += _missing(data) + _paused(data)
    if data.without_consent:
        sentences.append(
            f"Left out: {counted(data.without_consent, 'trainee')} who did not consent to research."
        )
    if data.outside_protocol:
        sentences.append(
            f"Left out: {counted(data.outside_protocol, 'trial')} that the protocol had not asked "
            "for."
        )
    sentences.append(
        "CTPS depends on the cohort and rises with slower completion; differences in CTPS are not "
        "differences in skill."
    )
    parts = [page.bullets(sentences)]
    if data.skipped:
        parts += [
            page.heading("Steps of the protocol that were left out"),
            page.bullets([f"{who}, {step}: {reason}" for who, step, reason in data.skipped]),
        ]
    if data.objections:
        parts += [
            page.heading("Trials that did not count, and why"),
            page.bullets([f"{who}, {what}: {reasons}" for who, what, reasons in data.objections]),
        ]
    return page.section("What cannot be concluded", *parts)


def what_cannot_be_concluded(
    n: int, comparison: PairedComparison | None = None, order_known: bool = True
) -> list[str]:
    """Return what a paired comparison of n subjects cannot show, in sentences.

    Args:
        comparison: Of theirs; None where none could be computed.
        order_known: Whether it is known which condition each subject did first.
    """
    if n < 2:
        return ["One subject allows no comparison: nothing can be said of anyone else."]
    with_period = comparison is not None and comparison.sequences is not None
    effect = detectable_effect(n, with_period=with_period)
    test = "a t-test with the period" if with_period else "a paired t-test"
    sentences = [
        f"With {n} subjects, {test} at the {percent(ALPHA)} level finds a true difference "
        f"in {percent(TARGET_POWER)} of studies only if it is at least {effect:.1f} times the "
        "standard deviation of the subjects' differences. Smaller ones are missed more often, "
        "and where one is found, its size tends to be overestimated."
    ]
    smallest = None
    if comparison is not None and comparison.ranks is not None:
        smallest = comparison.ranks.smallest_p
    if smallest is not None and smallest > ALPHA:
        name = "rank-sum" if with_period else "signed-rank"
        sentences.append(
            f"Wilcoxon's {name} test cannot reach the {percent(ALPHA)} level with {n} "
            f"subjects at all: its smallest possible p is {p_text(smallest)}."
        )
    if n < FEW_SUBJECTS:
        small, medium, large = (
            subjects_needed(size, with_period=with_period) for size in (0.2, 0.5, 0.8)
        )
        sentences += [
            f"To find a small, medium or large effect (d_z of 0.2, 0.5 or 0.8) as reliably, "
            f"{small}, {medium} or {large} subjects are needed.",
            "Whether the differences are normally distributed cannot be checked with so few.",
        ]
    return [*sentences, _about_order(with_period, order_known)]


def _about_order(with_period: bool, order_known: bool) -> str:
    if with_period:
        return (
            "What one condition leaves behind for the next one (carry-over) cannot be separated "
            "from the difference of the conditions where it is not equal in both directions. The "
            "analysis assumes that it is equal; the comparison of the sequences would show only a "
            "large inequality, and finding none proves nothing."
        )
    if not order_known:
        return (
            "Which condition the subjects did first is not in the data: practice and fatigue "
            "cannot be separated from the difference of the conditions, whatever the tests say."
        )
    return (
        "The subjects' orders of the conditions do not allow the effect of the period to be "
        "separated: practice and fatigue are part of the difference of the conditions. Only "
        "different orders, of four subjects or more, separate them."
    )


def _paused(data: StudyData) -> list[str]:
    count = sum(trial.values.get("pause_time_s", 0.0) > LONG_PAUSE_S for trial in data.trials)
    if not count:
        return []
    return [
        f"{count} of {len(data.trials)} trials were paused for more than {LONG_PAUSE_S:g} s in "
        "all. Completion time and score leave pauses out: time to think that others did not have."
    ]


def _missing(data: StudyData) -> list[str]:
    """Return the tasks some trainees lack: means over different tasks cannot be compared."""
    lacking = []
    for mode in data.modes:
        own = data.of_mode(mode)
        trainees = {trial.trainee for trial in own}
        for task in data.tasks:
            missing = len(trainees) - len({t.trainee for t in own if t.task == task})
            if missing:
                who = f"{missing} of {counted(len(trainees), 'trainee')}"
                lacking.append(f"{task_title(task)}, {mode_title(mode)}, of {who}")
    if not lacking:
        return []
    return [
        f"Trials are missing: {'; '.join(lacking)}. These trainees count with the tasks that they "
        "did in both modes."
    ]


REFERENCES = (
    "ISO 5725-1:2023, Accuracy (trueness and precision) of measurement methods and results",
    "Student 1908, The probable error of a mean. Biometrika 6",
    "Wilcoxon 1945, Individual comparisons by ranking methods. Biometrics Bulletin 1",
    "Hedges 1981, Distribution theory for Glass's estimator of effect size. J Educ Stat 6",
    "Steiger and Fouladi 1997, Noncentrality interval estimation. In: What if there were no "
    "significance tests?",
    "Holm 1979, A simple sequentially rejective multiple test procedure. Scand J Stat 6",
    "Hills and Armitage 1979, The two-period cross-over clinical trial. Br J Clin Pharmacol 8",
    "Koch 1972, The use of non-parametric methods in the statistical analysis of the two-period "
    "change-over design. Biometrics 28",
    "Senn 2002, Cross-over trials in clinical research",
    "Page 1963, Ordered hypotheses for multiple treatments: a significance test for linear ranks. "
    "J Am Stat Assoc 58",
    "Searle, Casella and McCulloch 1992, Variance components",
    "Ting, Burdick, Graybill, Jeyaratnam and Lu 1990, Confidence intervals on linear combinations "
    "of variance components that are unrestricted in sign. J Stat Comput Simul 35",
    "Burdick and Graybill 1992, Confidence intervals on variance components",
    "Wilson 1927, Probable inference, the law of succession, and statistical inference. "
    "J Am Stat Assoc 22",
    "Fitzpatrick, West and Maurer 1998, Predicting error in rigid-body point-based registration. "
    "IEEE Trans Med Imaging 17",
    "Harrington 1965, The desirability function. Industrial Quality Control 21",
    "Derringer and Suich 1980, Simultaneous optimization of several response variables. "
    "J Qual Technol 12",
    "Balasubramanian et al. 2015, On the analysis of movement smoothness. J Neuroeng Rehabil 12",
    "Newell and Rosenbloom 1981, Mechanisms of skill acquisition and the law of practice",
    "Biau and Porcher 2010, A method for monitoring a process from an out of control to an in "
    "control state: application to the learning curve. Stat Med 29",
    "Hartigan and Hartigan 1985, The dip test of unimodality. Ann Stat 13",
    "Hennig 2007, Cluster-wise assessment of cluster stability. Comput Stat Data Anal 52",
)


def methods(data: StudyData) -> str:
    """Return the section."""
    versions = [[name, ", ".join(found)] for name, found in data.versions.items()]
    own = [
        ["rastrainer (this report)", rastrainer.__version__],
        ["score", SCORE_VERSION],
        [
            "python, numpy, scipy (this report)",
            f"{platform.python_version()}, {np.__version__}, {scipy_module('version').version}",
        ],
    ]
    return page.section(
        "Methods and versions",
        page.paragraph(_design(data)),
        page.paragraph(_measures(data)),
        page.paragraph(ANALYSIS),
        page.heading("References"),
        page.bullets(REFERENCES),
        page.heading("Versions"),
        page.table([["what", "version"]], [*own, *versions]),
    )


def _design(data: StudyData) -> str:
    words = (
        f"{counted(len(data.trainees), 'trainee')} did {counted(len(data.trials), 'trial')} of "
        f"{counted(len(data.tasks), 'task')} in {counted(len(data.modes), 'mode')}. In each trial, "
        "fifteen "
        "numbered fiducials on a virtual head were touched in order with a teleoperated robot, and "
        "the touched points were registered rigidly to the fiducials in the MRI."
    )
    protocol = data.protocol
    if protocol is not None:
        mode_order = "balanced over the trainees" if protocol.mode_order == BALANCED else "fixed"
        task_order = (
            "a balanced Latin square (Williams 1949)"
            if protocol.task_order == BALANCED
            else "their fixed order"
        )
        times = "once" if protocol.repetitions == 1 else f"{protocol.repetitions} times"
        words += (
            f" The order of modes was {mode_order}; tasks came in {task_order}, {times} in each "
            "mode"
        )
        words += (
            f", after a trial run of {protocol.trial_run_min:g} min."
            if protocol.trial_run_min
            else ", without a trial run."
        )
    if data.notes is not None:
        words += f" {data.notes.participants} {data.notes.setting}"
    return words


def _measures(data: StudyData) -> str:
    words = (
        "Completion time runs from the start to the last kept touch, pauses left out. RMSE is the "
        "fiducial registration error of the rigid fit. CTPS is 100·(CT/mean CT − (RMSE − best "
        "RMSE)/best RMSE) with mean and best over all trials of the mode."
    )
    found = {name for trial in data.trials for name in trial.values}
    if "score" in found:
        words += _score(compared_method(data))
    if "sparc" in found:
        words += f" Motion metrics are of filtered trajectories ({FILTER})."
    return words


def _score(method: str) -> str:
    bias, bias_limit = "", ""
    if method == RegistrationMethod.FIDUCIALS:
        bias = (
            "This is multiplied by the trueness (ISO 5725-1) of the touches, "
            f"1/(1 + (b/{HALF_COMMON_BIAS_MM:g} mm)^{COMMON_BIAS_POWER}), with b the length of the "
            "bias along the skin that best explains the true errors of all touches (least "
            "squares), because on a small patch of skin such a bias hardly moves the brain. "
        )
        bias_limit = f"{COMMON_BIAS_LIMIT_MM:g} mm of common bias, "
    return (
        f" The RASTrainer score (version {SCORE_VERSION}, 0 to 100) is made of three "
        "desirabilities (Harrington 1965), each of the form 1/(1 + (value/half)²): the geometric "
        "mean (Derringer and Suich 1980) of time and accuracy, times the square root of safety. "
        "Accuracy is the true target error of the rigid registration, which the simulator reveals "
        "once the registration is final: the root mean square over the scenario's targets and "
        f"over a {SPACING_MM:g} mm grid of the brain, half and half (points at least "
        f"{UNDER_SKIN_MM:g} mm under the skin and at most {BELOW_VERTEX_MM:g} mm below the "
        f"vertex). {bias}Safety is the product of three: the time of unintended contact (one half "
        f"at {HALF_CONTACT_S:g} s), its path ({HALF_CONTACT_PATH_MM:g} mm) and the depth to which "
        f"the tool was pressed in ({HALF_DEPTH_MM:g} mm, root mean square over the fiducials). A "
        f"trial with more than {LIMIT_MM:g} mm of error (where the protocol sets no other limit), "
        f"{bias_limit}"
        f"{CONTACT_LIMIT_S:g} s, {CONTACT_PATH_LIMIT_MM:g} mm or {DEPTH_LIMIT_MM:g} mm deep scores "
        "below every trial of its task within the limits, and does not pass. The references of "
        "time and error are the same in all modes and, where the protocol sets none, come from the "
        "scenario: time from the path through the fiducials; the error by propagating independent "
        f"localization errors along the skin, of {REFERENCE_FLE_MM:.1f} mm, to the same region to "
        "first order (RASTrainer's own; Fitzpatrick, West and Maurer 1998 assume isotropic "
        "errors). "
        "Halves and limits are RASTrainer's own conventions."
    )


ANALYSIS = (
    "Modes were compared on trainee means over common tasks. Where trainees had different "
    "orders of the modes, the differences were regressed on the order, so that the effect of "
    "the period is separated (with two sequences the analysis of a crossover by Hills and "
    "Armitage), and ranks of later minus earlier were compared between the sequences "
    "(Wilcoxon's rank sums, exact; Koch 1972); else the paired t-test and the exact "
    "signed-rank test were used. Carry-over was assumed equal in both sequences. Mean "
    "differences have 95 % t intervals; Hedges' g_z is corrected for few subjects, and its "
    "95 % interval, by the noncentral t distribution, is one for the population's effect "
    "size. The p-values of the t-tests of completion time, RMSE and score were adjusted by "
    "Holm's method, as were those of Page's tests; all else is descriptive. CTPS was not "
    "tested: each mode has its own reference. The margin of equivalence is the least at which "
    "two one-sided tests reject at 5 %. Whether trainees get better was tested one-sided, "
    "since practice is expected to improve: for all together by Page's test, for each alone by "
    "a permutation test of the slope over ln(trial), over all orders or, of more than seven "
    "trials, 9999 random ones. What trials vary by was estimated by a "
    "regression of logarithms with a level for each trainee in each mode, and from an analysis "
    "of variance of these levels (Searle, Casella and McCulloch 1992), with intervals for "
    "differences of mean squares (Ting et al. 1990). Groups were looked for "
    "by the dip test on the first principal component of the z-scored trainee means. Outliers "
    "were not removed and missing values not filled in. How often each of these tests errs, "
    "and what it finds, "
    "is simulated in the program's docs/error-rates.md."
)
