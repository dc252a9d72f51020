"""Notes on a published study, from a file beside its CSV."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from rastrainer.files.json_fields import Fields, read_fields

QUANTITIES = (
    "overall",
    "equation_3_overall",
    "sd_population",
    "sd_sample",
    "pearson_r",
    "r_squared",
    "mean_ct",
    "mean_rmse",
)


@dataclass(frozen=True)
class Printed:
    """A number printed in a paper, and the computed quantity that it should equal."""

    what: str
    mode: str
    quantity: str
    printed: str


@dataclass(frozen=True)
class StudyNotes:
    """Notes on a study.

    Attributes:
        title: For people.
        source: Where the numbers come from.
        participants: Who took part, in a sentence.
        setting: How it was done, in a sentence.
        mean_ct_s: Mean completion times that the authors used, by mode.
        printed: Numbers to compare with ours.
        inconsistencies: Sentences about numbers that do not fit each other.
        claims: The authors' claims and, after each, what the numbers say to it.
    """

    title: str
    source: str
    participants: str
    setting: str
    mean_ct_s: Mapping[str, float]
    printed: tuple[Printed, ...]
    inconsistencies: tuple[str, ...]
    claims: tuple[tuple[str, str], ...]


def read_notes(path: Path) -> StudyNotes | None:
    """Read a file of notes; None where there is none.

    Raises:
        InputError: the file cannot be used.
    """
    if not path.exists():
        return None
    fields = read_fields(path)
    means = fields.fields("meanCtS")
    return StudyNotes(
        title=fields.text("title", 200),
        source=fields.text("source", 400),
        participants=fields.text("participants", 400),
        setting=fields.text("setting", 1000),
        mean_ct_s={mode: means.number(mode, 0.001, 1e6) for mode in means.names()},
        printed=tuple(_printed(entry) for entry in fields.list_of_fields("printed", 0, 50)),
        inconsistencies=tuple(
            entry.text("sentence", 1000)
            for entry in fields.list_of_fields("inconsistencies", 0, 50)
        ),
        claims=tuple(
            (entry.text("claim", 400), entry.text("numbers", 1000))
            for entry in fields.list_of_fields("claims", 0, 50)
        ),
    )


def _printed(entry: Fields) -> Printed:
    return Printed(
        entry.text("what", 100),
        entry.text("mode", 64),
        entry.one_of("quantity", QUANTITIES),
        entry.text("printed", 20),
    )
