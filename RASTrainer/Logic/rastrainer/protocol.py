"""The contract between the simulator and its clients: device names, phases, choices, limits.

Both sides import this file and `commands`, so they cannot diverge. `rastrainer.igtl` defines the
bytes.
"""

from __future__ import annotations

from enum import Enum

PROTOCOL_VERSION = 1
DEFAULT_HOST = "127.0.0.1"
DEFAULT_PORT = 18944
DEFAULT_VIEW_PORT = 18945
FIDUCIAL_COUNT = 15
TRIAL_RUN = "trial-run"
DECIDE = "decide"
"""The drill of decisions, where a task is named."""
MIN_TRACE_POINTS, MAX_TRACE_POINTS = 30, 500
"""Points of a trace: fewer do not determine a registration, more add next to nothing."""
TRACE_SPACING_MM = 1.0
"""How far the tip moves from one point of a trace to the next."""


class DeviceName:
    """OpenIGTLink device names of what the server sends; each becomes the name of a MRML node."""

    TOOL_TIP_TO_WORLD = "ToolTipToWorld"
    INSTRUMENT_TIP_TO_WORLD = "InstrumentTipToWorld"
    LINK_TO_WORLD = tuple(f"Link{i}ToWorld" for i in range(8))
    SIM_STATE = "SimState"
    CAPTURED_POINTS = "CapturedPoints"
    SIM_SERVER = "SimServer"
    COMMAND = "command"


class Rate:
    """How often each device is sent: poses and state in simulated time, others in wall time.

    Poses and state are sent at most this often, and only when changed.
    """

    TOOL_TIP_HZ = 60.0
    LINKS_HZ = 30.0
    STATE_HZ = 10.0
    HEARTBEAT_HZ = 1.0
    OFFER_PERIOD_S = 2.0


class Phase(str, Enum):
    """The state of a trial."""

    IDLE = "idle"
    RUNNING = "running"
    PAUSED = "paused"
    COMPLETE = "complete"
    VERIFYING = "verifying"
    ALIGNING = "aligning"
    DRILLING = "drilling"
    INSERTING = "inserting"
    REGISTERED = "registered"
    SCORED = "scored"


PROCEDURE_PHASES = (Phase.VERIFYING, Phase.ALIGNING, Phase.DRILLING, Phase.INSERTING)
"""The phases after the touches in a trial with a procedure; `aligning` to `inserting` come once for
each planned trajectory."""
OPEN_PHASES = (Phase.RUNNING, Phase.PAUSED, Phase.COMPLETE, *PROCEDURE_PHASES)
"""A trial that is running, paused, or not registered and delivered yet."""
FINISHED_PHASES = (Phase.REGISTERED, Phase.SCORED)


class AbortReason(str, Enum):
    """Why a trial ended without being registered."""

    TRAINEE = "trainee"
    CLIENT = "client"
    PRACTICE_OVER = "practice over"
    ABANDONED = "abandoned"


COMMANDED_ABORTS = (AbortReason.TRAINEE, AbortReason.CLIENT, AbortReason.PRACTICE_OVER)
"""In the simulator's menu, by a client's command, or at the end of a trial run's time. The other
reason is for a trial interrupted by the end of the simulator and not resumed before another."""
NUMBER_LIMIT = 1_000_000_000
"""The largest number of a trial in its simulator's folder."""
MIN_ABORTED_S = 10.0
"""An aborted trial without any touch is stored if it took longer than this."""


class Mode(str, Enum):
    """How the trainee sees the scene; the study compares them."""

    DESKTOP = "desktop"
    HMD = "hmd"


class RegistrationMethod(str, Enum):
    """How a head is registered: by touched points or a trace."""

    FIDUCIALS = "fiducials"
    LANDMARKS = "landmarks"
    SURFACE = "surface"
    SCAN = "scan"
    BONE_SCREWS = "bone-screws"
    LANDMARKS_SURFACE = "landmarks-surface"


TRACED_METHODS = (RegistrationMethod.SURFACE, RegistrationMethod.LANDMARKS_SURFACE)
"""In a trial by one of them the skin is traced after the landmarks were touched."""
PLAYED_METHODS = (RegistrationMethod.FIDUCIALS, RegistrationMethod.LANDMARKS, *TRACED_METHODS)
"""The methods by which a trial can be played."""
COARSE_LANDMARKS = 3
"""The first landmarks of the scenario, touched before the skin alone is traced."""


class TouchRule(str, Enum):
    """Which touch counts: only on the skin, or, as in the paper, anywhere near the fiducial."""

    ON_SKIN = "on skin"
    WITHIN_RADIUS = "within radius"


class Guidance(str, Enum):
    """How the trainee is guided to the next point.

    `WORDS`: distance and directions in words, and the arrow. `ARROW`: an arrow toward a point that
    is out of sight. `FADING`: words in the trial run, the arrow in the first two tasks, then none.
    """

    FADING = "fading"
    WORDS = "words"
    ARROW = "arrow"
    NONE = "none"


class GhostRule(str, Enum):
    """Which earlier trial of the same task is shown next to the arm.

    `OWN`: the trainee's own best acceptable one. `EXPERT`: a trial of the expert whom the
    simulator's settings name.
    """

    OFF = "off"
    OWN = "own best"
    EXPERT = "expert"


class TutorialRule(str, Enum):
    """Whether the tutorial comes before the trial run.

    `REQUIRED`: the trial run waits for it. `OPTIONAL`: trainees may leave it out. `SKIPPED`: there
    is none.
    """

    REQUIRED = "required"
    OPTIONAL = "optional"
    SKIPPED = "skipped"


class StepKind(str, Enum):
    """Kind of a step in a study."""

    QUESTIONNAIRE = "questionnaire"
    TRIAL_RUN = "trial-run"
    TRIAL = "trial"
    DECIDE = "decide"
    BREAK = "break"


class GoalKind(str, Enum):
    """When an assignment of a curriculum is reached.

    `SCORE`: some trials in a row pass. `COMPETENT`: its trials show competence by LC-CUSUM.
    """

    SCORE = "score"
    COMPETENT = "competent"


class AssignmentState(str, Enum):
    """Where a trainee stands with an assignment: `LOCKED` waits for others to be reached."""

    LOCKED = "locked"
    OPEN = "open"
    REACHED = "reached"


MAX_ASSIGNMENTS, MAX_GATES, MAX_GOAL_TRIALS = 24, 6, 50
"""Limits of a curriculum: assignments, how many an assignment waits for, and trials in a row."""
ALL_DONE, FREE, REPEAT = "all-done", "free", "repeat"
"""Instead of a step: none is left, the trainee follows no study, or the step's trial was aborted
and needs a reason to be repeated."""


class Proximity(str, Enum):
    """How near the tool is to the head; `proximity` means within the 20 mm sphere."""

    FREE = "free"
    PROXIMITY = "proximity"
    CONTACT = "contact"


MAX_JOURNAL_BYTES = 1 << 28
"""The longest journal that is delivered with its trial: more than ten hours."""
SPEED_LIMIT_MM_S = 500.0
WORLD_LIMIT_MM = 5000.0
STAND_OFF_LIMIT_MM = 80.0
"""The farthest that the guide's tip may be from the skin, along its axis, when it is locked."""
SKIN_LIMIT_MM = 20.0
SKIN_KEYS = ("shiftMm", "indentationMm")
FEED_LIMIT_MM_S = 50.0
"""Of `Feed`; drill and instrument have their own, lower limits."""
