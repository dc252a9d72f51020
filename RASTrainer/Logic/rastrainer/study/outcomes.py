"""The outcomes of trials: title, unit, and which direction is better.

The motion metrics have definitions, too, with their thresholds and sources.
"""

from __future__ import annotations

from dataclasses import dataclass

from rastrainer.motion.trajectory import (
    CUTOFF_HZ,
    FAR_MM,
    IDLE_DURATION_S,
    IDLE_SPEED_MM_S,
    INTENDED_MM,
    NEAR_MM,
    RELEASED_MM,
    SPARC_CUTOFF_HZ,
    SPARC_PAD_LEVEL,
    SPARC_THRESHOLD,
    TOUCHING_MM,
)
from rastrainer.motion.trial_motion import ACCEPTANCE_MM, DWELL_RADIUS_MM, RATE_HZ
from rastrainer.number_text import fixed

OWN = "RASTrainer"
FILTER = (
    f"resampled to {RATE_HZ:g} Hz, zero-phase second-order Butterworth low pass at {CUTOFF_HZ:g} Hz"
)
MODE_TITLES = {"desktop": "Desktop", "hmd": "Headset (HMD)"}
MODE_NAMES = {"desktop": "the desktop screen", "hmd": "the headset"}


@dataclass(frozen=True)
class Outcome:
    """An outcome of a trial.

    Attributes:
        name: Key in a trial's values, with the unit at its end where it has one.
        definition: Of a motion metric, one sentence with every threshold; else "".
        better: -1 if less is better, 1 if more is, 0 if neither.
    """

    name: str
    title: str
    definition: str = ""
    unit: str = ""
    better: int = 0
    digits: int = 2
    source: str = OWN

    @property
    def heading(self) -> str:
        """Title with unit."""
        return f"{self.title}, {self.unit}" if self.unit else self.title

    def text(self, value: float) -> str:
        """Return a value with its decimals, without its unit."""
        return fixed(value, self.digits)


MOTION_METRICS: dict[str, Outcome] = {
    metric.name: metric
    for metric in (
        Outcome(
            "completion_time_s",
            "Completion time",
            "From the start of the trial to the last kept touch, without pauses.",
            unit="s",
            better=-1,
            digits=1,
            source="the paper, section V",
        ),
        Outcome(
            "path_length_mm",
            "Path length",
            f"Length of the path of the tool's tip ({FILTER}).",
            unit="mm",
            better=-1,
            digits=0,
            source="Cotin et al. 2002",
        ),
        Outcome(
            "path_between_touches_mm",
            "Path length between touches",
            f"Path length from the first touch to the last ({FILTER}).",
            unit="mm",
            better=-1,
            digits=0,
            source="Cotin et al. 2002",
        ),
        Outcome(
            "path_efficiency",
            "Path efficiency",
            "Shortest free path through all fiducials (straight, or along the skin where the head "
            "is in the way) divided by the path length between touches; 1 is direct.",
            better=1,
            source="Cotin et al. 2002; path along the skin: Dijkstra 1959 on the mesh",
        ),
        Outcome("mean_speed_mm_s", "Mean speed", f"Mean speed of the tip ({FILTER}).", unit="mm/s"),
        Outcome(
            "peak_speed_mm_s", "Peak speed", f"Highest speed of the tip ({FILTER}).", unit="mm/s"
        ),
        Outcome(
            "sparc",
            "Smoothness, SPARC",
            "Spectral arc length of the speed of each movement from touch to touch, median "
            f"(cut-off {SPARC_CUTOFF_HZ:g} Hz, threshold {SPARC_THRESHOLD:g}, "
            f"{SPARC_PAD_LEVEL} more powers of two of zero padding; {FILTER}).",
            better=1,
            source="Balasubramanian, Melendez-Calderon, Roby-Brami, Burdet 2015",
        ),
        Outcome(
            "ldlj",
            "Smoothness, log dimensionless jerk",
            f"Negative log dimensionless jerk of the speed of each movement, median ({FILTER}).",
            better=1,
            source="Balasubramanian, Melendez-Calderon, Burdet 2012",
        ),
        Outcome(
            "movement_time_s",
            "Movement time",
            "Time from touch to touch, median.",
            unit="s",
            better=-1,
        ),
        Outcome(
            "time_to_peak_speed",
            "Share of time to peak speed",
            "When in a movement the speed is highest, as a share of its time, median; an early "
            "peak means long corrections.",
        ),
        Outcome(
            "idle_time_s",
            "Idle time",
            f"Time with the tip slower than {IDLE_SPEED_MM_S:g} mm/s for more than "
            f"{IDLE_DURATION_S:g} s at a stretch, up to the last touch that counts.",
            unit="s",
            better=-1,
        ),
        Outcome(
            "dwell_before_touch_s",
            "Dwell before a touch",
            f"How long the tip had stayed within {DWELL_RADIUS_MM:g} mm of the place that was then "
            "touched, median.",
            unit="s",
        ),
        Outcome(
            "throughput_bit_s",
            "Throughput",
            "Mean over the movements of log2(De/We + 1) over movement time, We = 4.133 times the "
            "RMS distance of the end points from their targets along the task axes (ISO: SD about "
            "their own mean, which a constant offset leaves at 0).",
            unit="bit/s",
            better=1,
            source="after ISO 9241-411; MacKenzie 1992",
        ),
        Outcome(
            "effective_width_mm",
            "Effective width of the targets",
            "We = 4.133 times the RMS distance of the end points from their targets along the task "
            "axes.",
            unit="mm",
            better=-1,
            source="after ISO 9241-411",
        ),
        Outcome(
            "proximity_time_s",
            "Time near the head",
            f"Time with the tip within {NEAR_MM:g} mm of the head (until {FAR_MM:g} mm) or the "
            "tool touching it.",
            unit="s",
            source="the paper, section III B 2",
        ),
        Outcome(
            "contacts",
            "Contacts",
            f"How often the tool came to touch the head (clearance up to {TOUCHING_MM:g} mm, ended "
            f"at {RELEASED_MM:g} mm).",
        ),
        Outcome(
            "unintended_contacts",
            "Contacts away from a touch",
            f"Contacts that began farther than {ACCEPTANCE_MM:g} mm from the place that was "
            "touched next and from the one touched last.",
            better=-1,
        ),
        Outcome(
            "unintended_contact_time_s",
            "Time of contact away from a touch",
            f"Time in contact with the head while the tip was farther than {INTENDED_MM:g} mm from "
            "the place that was touched next and from the one touched last (of the kept touches; "
            "where there are none, all contact).",
            unit="s",
            better=-1,
        ),
        Outcome(
            "unintended_contact_path_mm",
            "Path of contact away from a touch",
            "Length of the path of the tip during that time (as sampled, not filtered).",
            unit="mm",
            better=-1,
        ),
        Outcome(
            "pressing_depth_mm",
            "Pressing depth",
            "Square root of the sum over all contacts of the squared greatest depth in it (taken "
            "once for each kept touch in it, at least once) over the number of fiducials; depth is "
            "how far the commanded motion went into the head beyond where the tool could go.",
            unit="mm",
            better=-1,
            source="after the god object of Zilles and Salisbury 1995",
        ),
        Outcome(
            "contact_time_s", "Contact time", "Time in contact with the head.", unit="s", better=-1
        ),
        Outcome(
            "deepest_contact_mm",
            "Deepest contact",
            "How far the tool was in the head at most; the simulator lets it slide, not sink in.",
            unit="mm",
            better=-1,
        ),
        Outcome(
            "least_clearance_mm",
            "Least clearance",
            "Smallest signed distance of the tool to the head.",
            unit="mm",
        ),
        Outcome(
            "refused_touches",
            "Refused touches",
            f"Touches farther than {ACCEPTANCE_MM:g} mm from the fiducial that was due, or above "
            "the skin where a touch has to be on it.",
            better=-1,
        ),
        Outcome(
            "wrong_order_touches",
            "Touches of a wrong fiducial",
            f"Refused touches within {ACCEPTANCE_MM:g} mm of another fiducial.",
            better=-1,
        ),
        Outcome("undone_touches", "Undone touches", "Number of touches that the trainee undid."),
        Outcome("camera_switches", "Camera switches", "How often the view was changed."),
        Outcome("pauses", "Pauses", "How often the trial was paused."),
        Outcome(
            "pause_time_s",
            "Time paused",
            "How long the trial was paused in all; it is left out of the completion time.",
            unit="s",
        ),
    )
}
MAIN_OUTCOMES = (
    MOTION_METRICS["completion_time_s"],
    Outcome("rmse_mm", "Registration error (RMSE)", unit="mm", better=-1),
    Outcome("ctps", "CTPS as published", digits=1),
    Outcome("expected_tre_mm", "Expected target error", unit="mm", better=-1),
    Outcome("true_tre_mm", "True target error", unit="mm", better=-1),
    Outcome("score_tre_mm", "True error in the brain", unit="mm", better=-1),
    Outcome("score_common_bias_mm", "Bias that all touches share", unit="mm", better=-1),
    Outcome("score", "RASTrainer score", better=1, digits=1),
)
MOTION_OUTCOMES = tuple(
    metric for metric in MOTION_METRICS.values() if metric.name != "completion_time_s"
)
CLUSTER_METRICS = (
    "completion_time_s",
    "rmse_mm",
    "path_between_touches_mm",
    "sparc",
    "idle_time_s",
)
"""Metrics for grouping trainees, if all have them; few, because of few trainees."""


def mode_title(mode: str) -> str:
    return MODE_TITLES.get(mode, mode)


def short_mode_title(mode: str) -> str:
    """Return the first word of a mode's title, for narrow columns and charts."""
    return mode_title(mode).split(" ")[0]


def mode_name(mode: str) -> str:
    return MODE_NAMES.get(mode, mode)


def task_title(task: str) -> str:
    return f"Task {task}" if task.isdigit() else task.replace("-", " ").capitalize()
