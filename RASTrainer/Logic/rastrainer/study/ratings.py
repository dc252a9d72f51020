"""Blinded rating of replays: the forms, and the raters' marks in a study.

Each mark is stored once, none is overwritten, the latest count.
"""

from __future__ import annotations

import json
import random
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from rastrainer.errors import InputError
from rastrainer.json_checks import accepted, pseudonym, text
from rastrainer.json_records import record_from_json
from rastrainer.study.database.study import Study

LOWEST, HIGHEST = 1, 5
MARKS = range(LOWEST, HIGHEST + 1)


@dataclass(frozen=True)
class RatingDomain:
    """One line of a form, marked from 1 to 5; its name is the key of its sentences, too."""

    name: str
    title: str


@dataclass(frozen=True)
class RatingForm:
    """A form of domains that are marked from 1 (worst) to 5 (best), and added up.

    Names of domains and the scale are as published. The sentences that describe marks are our own,
    in the simulator's texts: the published sentences belong to their authors. Domains that a replay
    cannot show are left out, by their titles, with the reason.
    """

    name: str
    title: str
    domains: tuple[RatingDomain, ...]
    left_out: Mapping[str, str]
    source: Annotated[str, text(300)]

    @property
    def lowest_total(self) -> int:
        return LOWEST * len(self.domains)

    @property
    def highest_total(self) -> int:
        return HIGHEST * len(self.domains)


_FILE = Path(__file__).with_name("rating_forms.json").read_text(encoding="utf-8")
GEARS, OSATS = (record_from_json(RatingForm, each) for each in json.loads(_FILE))
FORMS = {form.name: form for form in (GEARS, OSATS)}


@dataclass(frozen=True)
class Rating:
    """All marks that a rater gave a trial on one form, by domain."""

    rater: str
    trial_id: str
    form: str
    marks: Mapping[str, int]

    @property
    def total(self) -> int:
        return sum(self.marks.values())


class RatingStore:
    """The ratings of one study. One thread may use it."""

    def __init__(self, study: Study) -> None:
        self._database = study.database

    def assign(
        self, rater: str, trial_ids: Collection[str], count: int, chance: random.Random
    ) -> tuple[str, ...]:
        """Assign replays to a rater; return their trials in the rater's order.

        All raters get the same trials; if the other raters have fewer than `count`, more are drawn
        at random from `trial_ids`. Each rater gets them in another order. A
        rater's earlier replays keep their places.
        """
        rater = accepted(pseudonym, rater, "The name of a rater")
        with self._database.writing():
            rows = self._database.rows("SELECT DISTINCT trial_id FROM rated_replays")
            chosen = {trial_id for (trial_id,) in rows}
            # Sorted: the same chance draws the same trials.
            others = sorted(set(trial_ids) - chosen)
            missing = min(max(0, count - len(chosen)), len(others))
            chosen |= set(chance.sample(others, missing))
            present = self._order(rater)
            added = sorted(chosen - set(present))
            chance.shuffle(added)
            query = "SELECT coalesce(max(number), 0) FROM rated_replays WHERE rater = ?"
            last = self._database.row(query, rater)[0]
            for number, trial_id in enumerate(added, start=last + 1):
                self._database.insert(
                    "rated_replays", rater=rater, number=number, trial_id=trial_id
                )
            return (*present, *added)

    def give(
        self,
        mark_id: str,
        rater: str,
        trial_id: str,
        form: RatingForm,
        domain: str,
        mark: int | None,
    ) -> bool:
        """Store a mark, or with None that the latest is taken back; return whether it was new.

        The same UUID (`mark_id`) again changes nothing.
        """
        if domain not in {each.name for each in form.domains}:
            raise InputError(f"{form.title} has no domain {domain[:40]!r}.")
        if mark is not None and (isinstance(mark, bool) or mark not in MARKS):
            raise InputError(f"A mark is a whole number from {MARKS[0]} to {MARKS[-1]}.")
        given: dict[str, Any] = {"rater": rater, "trial_id": trial_id, "form": form.name}
        given |= {"domain": domain, "mark": mark}
        with self._database.writing():
            query = f"SELECT {', '.join(given)} FROM rating_marks WHERE mark_id = ?"
            row = self._database.row(query, mark_id)
            if row is not None and row != tuple(given.values()):
                raise InputError(f"Another mark is stored under the UUID {mark_id[:40]}.")
            if row is not None:
                return False
            if trial_id not in self._order(rater):
                raise InputError(f"The rater {rater[:64]} was not given this replay.")
            self._database.insert("rating_marks", mark_id=mark_id, **given)
            return True

    def marks(self, rater: str, trial_id: str) -> dict[str, int]:
        """Return the marks that count, by domain, in the order in which they were given."""
        return _latest(
            self._database.rows(
                "SELECT domain, mark FROM rating_marks WHERE rater = ? AND trial_id = ? "
                "ORDER BY id",
                rater,
                trial_id,
            )
        )

    def ratings(self) -> tuple[Rating, ...]:
        """Return every form that a rater has filled in, by form, rater and trial."""
        rows = self._database.rows(
            "SELECT form, rater, trial_id, domain, mark FROM rating_marks ORDER BY id"
        )
        given: dict[tuple[str, str, str], list[tuple[str, int | None]]] = {}
        for form, rater, trial_id, domain, mark in rows:
            given.setdefault((form, rater, trial_id), []).append((domain, mark))
        found = []
        for (form, rater, trial_id), marks in sorted(given.items()):
            latest = _latest(marks)
            if form in FORMS and set(latest) == {each.name for each in FORMS[form].domains}:
                found.append(Rating(rater, trial_id, form, latest))
        return tuple(found)

    def _order(self, rater: str) -> list[str]:
        query = "SELECT trial_id FROM rated_replays WHERE rater = ? ORDER BY number"
        return [trial_id for (trial_id,) in self._database.rows(query, rater)]


def _latest(marks: Sequence[tuple[str, int | None]]) -> dict[str, int]:
    """Return the latest mark of each domain that was not taken back."""
    latest: dict[str, int] = {}
    for domain, mark in marks:
        latest.pop(domain, None)
        if mark is not None:
            latest[domain] = mark
    return latest
