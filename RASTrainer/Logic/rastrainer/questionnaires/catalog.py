"""The questionnaires that a study may use."""

from __future__ import annotations

from rastrainer.errors import InputError
from rastrainer.questionnaires.nasa_tlx import NASA_TLX
from rastrainer.questionnaires.questionnaire import Questionnaire
from rastrainer.questionnaires.ssq import SSQ
from rastrainer.questionnaires.sus import SUS

QUESTIONNAIRES = {q.name: q for q in (SUS, NASA_TLX, SSQ)}


def find_questionnaire(name: str) -> Questionnaire:
    """Return a questionnaire; raise `InputError` with those there are if this is none."""
    if name not in QUESTIONNAIRES:
        raise InputError(
            f"There is no questionnaire {name[:40]!r}; known are {', '.join(QUESTIONNAIRES)}."
        )
    return QUESTIONNAIRES[name]
