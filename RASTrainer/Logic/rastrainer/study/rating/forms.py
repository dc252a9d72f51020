"""Global rating forms: their domains, and which of them a replay can show."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rastrainer.errors import InputError

LOWEST, HIGHEST = 1, 5
MARKS = range(LOWEST, HIGHEST + 1)


@dataclass(frozen=True)
class RatingDomain:
    """One line of a form, marked from 1 to 5.

    Attributes:
        name: For data files, and the key of its sentences for 1, 3 and 5.
        title: As published.
    """

    name: str
    title: str


@dataclass(frozen=True)
class RatingForm:
    """A form of domains that are marked from 1 (worst) to 5 (best), and added up.

    Names of domains and the scale are as published. The sentences that describe marks are our own,
    in the simulator's texts: the published ones are their authors'.

    Attributes:
        name: For data files.
        title: For people.
        domains: Those that a replay can show, in their order.
        left_out: Titles of the published domains that it cannot show, with the reason.
        source: Publication of domains and scale.
    """

    name: str
    title: str
    domains: tuple[RatingDomain, ...]
    left_out: Mapping[str, str]
    source: str

    @property
    def lowest_total(self) -> int:
        """The total of the worst marks."""
        return LOWEST * len(self.domains)

    @property
    def highest_total(self) -> int:
        """The total of the best marks."""
        return HIGHEST * len(self.domains)


GEARS = RatingForm(
    name="gears",
    title="GEARS",
    domains=(
        RatingDomain("gears_depth", "Depth perception"),
        RatingDomain("gears_efficiency", "Efficiency"),
        RatingDomain("gears_force", "Force sensitivity"),
        RatingDomain("gears_control", "Robotic control"),
    ),
    left_out={
        "Bimanual dexterity": "the trainee drives one arm",
        "Autonomy": "a replay does not show who has helped",
    },
    source="Goh, Goldfarb, Sander, Miles and Dunkin 2012, Global evaluative assessment of robotic "
    "skills: validation of a clinical assessment tool to measure robotic surgical skills",
)
OSATS = RatingForm(
    name="osats",
    title="OSATS global rating",
    domains=(
        RatingDomain("osats_tissue", "Respect for tissue"),
        RatingDomain("osats_motion", "Time and motion"),
        RatingDomain("osats_handling", "Instrument handling"),
        RatingDomain("osats_flow", "Flow of operation and forward planning"),
    ),
    left_out={
        "Knowledge of instruments": "there is one instrument",
        "Use of assistants": "there are none",
        "Knowledge of specific procedure": "the simulator leads through it",
    },
    source="Martin, Regehr, Reznick, MacRae, Murnaghan, Hutchison and Brown 1997, Objective "
    "structured assessment of technical skill (OSATS) for surgical residents",
)

FORMS = {form.name: form for form in (GEARS, OSATS)}


def find_form(name: str) -> RatingForm:
    """Return a form; raise `InputError` if unknown."""
    if name not in FORMS:
        raise InputError(f"There is no form {name[:40]!r}; known are {', '.join(FORMS)}.")
    return FORMS[name]
