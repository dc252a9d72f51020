"""The registration of a trial as Slicer's side computes it, from what the simulator answers."""

from __future__ import annotations

from typing import Any

from rastrainer.igtl.client import Client
from rastrainer.json_records import record_from_json
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.touch_registration import GivenPoints, register_trial


def registration_of(client: Client, trial_id: str, scenario: Scenario) -> dict[str, Any]:
    """Return the arguments of UseRegistration or SubmitRegistration for a trial."""
    reply = client.send_command("GetTrial", {"trialId": trial_id}, timeout=60)
    assert reply.ok, reply.error
    given = (
        GivenPoints.of_record(record_from_json(TrialRecord, reply.data["record"]))
        if "record" in reply.data
        else GivenPoints.of_answer(reply.data)
    )
    return register_trial(given, scenario).arguments(trial_id)
