"""A client's registration is accepted only if it is the fit of the trial's own points.

The simulator has the touches and the trace, so it registers them itself and compares. The journal
gets its own outcome, the same for every client, whose numpy may round otherwise.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from typing import Any

import numpy as np

from rastrainer.commands import CommandName
from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json
from rastrainer.protocol import TRACED_METHODS, Phase
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.touch_registration import GivenPoints, register_trial
from rastrainer_simulator.state import Answer, OperatorCommand, TrainingState
from rastrainer_simulator.training.rules import REFUSALS, refusal

SubmitCommand = Callable[[str, Mapping[str, Any], str], "Future[Answer]"]
CHECKED = (CommandName.USE_REGISTRATION, CommandName.SUBMIT_REGISTRATION)
"""Commands with a registration."""
TOLERANCE, TRACE_TOLERANCE = 1e-6, 1e-4
"""For each number of a matrix (mm in its last column) and the FRE. A trace is matched in steps,
which enlarge a difference of 1e-11 mm in its points to 1e-6."""
_REST_S = 0.002


def submit_checked(
    submit: SubmitCommand,
    training: Callable[[], TrainingState],
    find_scenario: Callable[[str], Scenario],
    name: str,
    arguments: Mapping[str, Any],
    sender: str,
) -> Answer:
    """Have a command of `CHECKED` carried out if its registration is the trial's.

    It waits for answers, and registers the trial itself: not in the event loop's thread.
    `find_scenario` gives the present scenario for "".
    """
    trial = {"trialId": arguments["trialId"]}
    found = submit(CommandName.GET_TRIAL, trial, sender).result()
    if not found.ok:
        return found
    if found.data["phase"] not in {each.value for each in Phase if each not in REFUSALS[name]}:
        # The state may have changed meanwhile.
        sentence = refusal(OperatorCommand(name, arguments), training())
        return Answer(0, False, sentence or f"{name} is not due in this trial.")
    data = found.data
    try:
        record = record_from_json(TrialRecord, data["record"]) if "record" in data else None
        given = GivenPoints.of_answer(data) if record is None else GivenPoints.of_record(record)
        scenario = find_scenario("" if record is None else record.scenario)
        registered = register_trial(given, scenario, pause=lambda: time.sleep(_REST_S))
        fit = registered.arguments(arguments["trialId"])
    except InputError as error:
        return Answer(0, False, str(error))
    own = (*fit["matrix"], fit["freMm"])
    theirs = (*arguments["matrix"], arguments["freMm"])
    tolerance = TRACE_TOLERANCE if given.method in TRACED_METHODS else TOLERANCE
    off = float(np.abs(np.subtract(own, theirs)).max())
    if off > tolerance:
        sentence = (
            f"The registration must be the rigid one of the trial's points: its matrix and FRE "
            f"may be off by {tolerance:g}, and are by {off:.3g}."
        )
        return Answer(0, False, sentence)
    return submit(name, fit, sender).result()
