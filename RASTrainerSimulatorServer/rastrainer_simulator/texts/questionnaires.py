"""What questionnaires ask about, by the items' names; the published wording is its authors'."""

from __future__ import annotations

from collections.abc import Mapping

from rastrainer.questionnaires.catalog import QUESTIONNAIRES

ENGLISH_ITEMS: Mapping[str, str] = {
    **{item.name: item.topic for asked in QUESTIONNAIRES.values() for item in asked.items},
    **{
        f"{item.name}.{end}": word
        for asked in QUESTIONNAIRES.values()
        for item in asked.items
        for end, word in zip(("low", "high"), item.anchors, strict=False)
    },
    **{f"{asked.name}.low": asked.anchors[0] for asked in QUESTIONNAIRES.values()},
    **{f"{asked.name}.high": asked.anchors[1] for asked in QUESTIONNAIRES.values()},
}

GERMAN_ITEMS: Mapping[str, str] = {
    "sus_1": "würde es gern häufig benutzen",
    "sus_2": "unnötig komplex",
    "sus_3": "einfach zu benutzen",
    "sus_4": "brauche die Hilfe einer technisch kundigen Person",
    "sus_5": "Funktionen gut aufeinander abgestimmt",
    "sus_6": "zu viele Unstimmigkeiten",
    "sus_7": "die meisten lernen es schnell",
    "sus_8": "umständlich",
    "sus_9": "fühlte mich sicher",
    "sus_10": "musste vorher viel lernen",
    "sus.low": "stimme gar nicht zu",
    "sus.high": "stimme völlig zu",
    "tlx_mental": "Geistige Anforderung",
    "tlx_physical": "Körperliche Anforderung",
    "tlx_temporal": "Zeitliche Anforderung",
    "tlx_performance": "Leistung",
    "tlx_performance.low": "perfekt",
    "tlx_performance.high": "Misserfolg",
    "tlx_effort": "Anstrengung",
    "tlx_frustration": "Frustration",
    "nasa-tlx.low": "sehr gering",
    "nasa-tlx.high": "sehr hoch",
    "ssq_discomfort": "Allgemeines Unwohlsein",
    "ssq_fatigue": "Müdigkeit",
    "ssq_headache": "Kopfschmerzen",
    "ssq_eyestrain": "Überanstrengte Augen",
    "ssq_focusing": "Schwierigkeiten, scharf zu sehen",
    "ssq_salivation": "Erhöhter Speichelfluss",
    "ssq_sweating": "Schwitzen",
    "ssq_nausea": "Übelkeit",
    "ssq_concentrating": "Konzentrationsschwierigkeiten",
    "ssq_fullness": "Druckgefühl im Kopf",
    "ssq_blurred": "Verschwommenes Sehen",
    "ssq_dizzy_open": "Schwindel bei offenen Augen",
    "ssq_dizzy_closed": "Schwindel bei geschlossenen Augen",
    "ssq_vertigo": "Drehschwindel",
    "ssq_stomach": "Magen macht sich bemerkbar",
    "ssq_burping": "Aufstoßen",
    "ssq.low": "gar nicht",
    "ssq.high": "stark",
}
