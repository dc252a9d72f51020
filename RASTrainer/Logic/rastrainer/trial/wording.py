"""What 3D Slicer and the simulator both say, in English, with keys for translation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rastrainer.number_text import PAST_HALF

ENGLISH: Mapping[str, str] = {
    "skin": "The skin had shifted by {shift:.1f} mm (RMS) and was indented by "
    "{indentation:.1f} mm: the true error at the target was {tre:.2f} mm.",
    "skin and error": "The skin had shifted by {shift:.1f} mm (RMS) and was indented by "
    "{indentation:.1f} mm: the true error at the target was {tre:.2f} mm, and would have been "
    "{without:.2f} mm without that.",
    "touch": "Point {label} was {residual:.1f} mm off{where}{hurry}{shaking}.",
    "touch above": ", mostly in depth ({depth:.1f} mm above the skin)",
    "touch below": ", mostly in depth ({depth:.1f} mm below the skin)",
    "touch aside": ", mostly along the skin",
    "touch hurry": "; you hurried: hold still for a moment before you touch",
    "touch shaking": "; the tip shook: use the fine speed for the last centimeter",
    "no touch": "No touch stands out: the errors are spread evenly.",
    "contact": "You bumped into the head once on the way. Lift off before you travel to the next "
    "point.",
    "contacts": "You bumped into the head {count} times on the way. Lift off before you travel to "
    "the next point.",
    "dragging": "The tool lay on the head for {time:.0f} s away from the points, over {path:.0f} "
    "mm: lift off before you travel to the next point.",
    "pressing": "You pressed {depth:.1f} mm into the head at the points: stop as soon as the tip "
    "touches the skin.",
    "worst touch": "Take more care at point {points}: without this error the registration would "
    "be about {share:.0f} % more accurate.",
    "worst touches": "Take more care at points {points}: without these errors the registration "
    "would be about {share:.0f} % more accurate.",
    "depth": "Most of the error is in depth: bring the tip all the way onto the skin, and look "
    "from the side before you touch.",
    "common bias": "On average, the touches are {bias:.1f} mm too far {direction}, which the "
    "registration error cannot show: look at the tip from a second side before you touch.",
    "oblique common bias": "On average, the touches are {bias:.1f} mm too far {direction} and "
    "{second}, which the registration error cannot show: look at the tip from a second side before "
    "you touch.",
    "bias to the left": "to the patient's left",
    "bias to the right": "to the patient's right",
    "bias to the back": "toward the back of the head",
    "bias to the face": "toward the face",
    "bias to the neck": "toward the neck",
    "bias to the crown": "toward the crown",
    "idle time": "The tool stood still for {idle:.0f} s of {time:.0f} s: look for the next point "
    "while you are still at this one.",
    "detours": "The tool traveled {times:.1f} times the shortest path: move around the head "
    "closer to it and in one sweep.",
    "repeated touch": "1 touch was refused or undone: check the number of the point before you "
    "touch.",
    "repeated touches": "{count} touches were refused or undone: check the number of the point "
    "before you touch.",
    "pace": "You took {time:.0f} s where {usual:.0f} s is usual: travel faster between the points "
    "and slow down only near the skin.",
    "first trial": "This is your first trial of this task in this mode.",
    "first by this method": "Your earlier trials of this task were registered by another method, "
    "and their scores cannot be compared with this one.",
    "more points": "Your score is {points:.0f} above the mean of your last {trials} trials of this "
    "task.{best}",
    "less points": "Your score is {points:.0f} below the mean of your last {trials} trials of this "
    "task.{best}",
    "more points than last": "Your score is {points:.0f} above that of your last trial of this "
    "task.{best}",
    "less points than last": "Your score is {points:.0f} below that of your last trial of this "
    "task.{best}",
    "best": " It is your best so far.",
    "unacceptable": "Not passed: the true error in the brain, the bias that all touches share, or "
    "the contact with the head is beyond what is acceptable.",
    "passed": "Passed: the mark is {mark:.0f}.",
    "not passed": "Not passed yet: {points:.1f} short of the mark of {mark:.0f}.",
    "no mark": "Neither passed nor failed: the pass mark of this study is for trials registered "
    "by fiducials.",
    "competent": "Your trials have shown competence since number {number}: of those who still fail "
    "in {failing:.0f} % of their trials, {risk:.0f} % get this far by chance within {trials} "
    "trials, and more where good and bad days alternate (LC-CUSUM).",
    "not competent": "{share:.0f} % of the way to demonstrated competence (LC-CUSUM; trials so "
    "far: {trials}).",
}

PARTS = {
    "time": "time",
    "accuracy": "accuracy",
    "common bias": "the bias that all touches share",
    "safety": "unintended contact and pressing",
    "target": "the error at the target",
    "entry": "the error at the entry",
    "angle": "the angle",
    "plunge": "drilling too deep",
    "distance": "too little distance to no-go structures",
}
"""The parts of the scores of touches and of procedures."""
IN_MODE = {"desktop": "on the desktop screen", "hmd": "with the headset"}
BY_METHOD = {
    "landmarks": "by landmarks of the face",
    "surface": "by a trace over the skin",
    "landmarks-surface": "by landmarks and a trace",
}
"""Fiducials, the default method, are not mentioned."""
TABLES: Mapping[str, Mapping[str, str]] = {
    "feedback.": ENGLISH,
    "assignments.part ": PARTS,
    "study.": IN_MODE,
    "study.by ": BY_METHOD,
}
"""All of them, by what the keys begin with in the simulator's texts."""


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
