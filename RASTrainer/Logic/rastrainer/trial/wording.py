"""What 3D Slicer and the simulator both say, in English, with keys for translation.

`wording.json` has it: sentences of feedback, the parts of the scores of touches and of procedures,
modes, and methods but for fiducials, the default, which is not mentioned.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rastrainer.number_text import PAST_HALF

TABLES: Mapping[str, Mapping[str, str]] = json.loads(
    Path(__file__).with_name("wording.json").read_text(encoding="utf-8")
)
"""All of them, by what the keys begin with in the simulator's texts."""
ENGLISH, PARTS = TABLES["feedback."], TABLES["assignments.part "]
IN_MODE, BY_METHOD = TABLES["study."], TABLES["study.by "]


class Sentence(str):
    """An English sentence with its key and values: numbers, texts, and partial sentences."""

    key: str
    values: Mapping[str, Any]

    def to_json(self) -> dict[str, Any]:
        values = {
            name: value.to_json() if isinstance(value, Sentence) else value
            for name, value in self.values.items()
        }
        return {"key": self.key, "values": values, "text": str(self)}


def say(key: str, **values: Any) -> Sentence:
    rounded = {
        name: value * PAST_HALF if isinstance(value, float) else value
        for name, value in values.items()
    }
    sentence = Sentence(ENGLISH[key].format(**rounded))
    sentence.key, sentence.values = key, rounded
    return sentence
