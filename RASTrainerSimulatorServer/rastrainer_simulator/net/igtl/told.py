"""A trial's sentences as clients are told them: without the distances that the trainee reads.

Beside the exact pose of the tip, distances to the head or to a point would give the secret pose of
the head (`Testing/security/pose_leak.py`).
"""

from __future__ import annotations

from collections.abc import Mapping

from rastrainer_simulator.texts.texts import LocalizedText, Texts

_WITHOUT_DISTANCE: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "too far": (
        "Too far from point {point}: a touch counts within {radius:g} mm.",
        ("point", "radius"),
    ),
    "above the skin": ("The tip is above the skin: lower it onto point {point}.", ("point",)),
    "wrong point": (
        "Wrong point: that is point {label}; point {point} is next.",
        ("point", "label"),
    ),
    "above a checkpoint": ("The tip is above the skin: lower it onto the checkpoint.", ()),
    "too far to lock": (
        "The guide's tip is too far from the skin along its axis: lock it within {limit:.0f} mm.",
        ("limit",),
    ),
}
_TOLD = Texts({key: text for key, (text, _values) in _WITHOUT_DISTANCE.items()})
_SAME = {"much too far": "too far"}


def told(sentence: str) -> str:
    """Return a sentence in English, without what would tell the pose of the head."""
    if not isinstance(sentence, LocalizedText):
        return sentence
    key = _SAME.get(sentence.key, sentence.key)
    kept = _WITHOUT_DISTANCE[key][1] if key in _WITHOUT_DISTANCE else tuple(sentence.values)
    return _TOLD.say(key, **{name: sentence.values[name] for name in kept})
