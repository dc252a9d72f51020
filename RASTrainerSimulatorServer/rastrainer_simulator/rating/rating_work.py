"""The replays that a rater marks, and which domain comes next."""

from __future__ import annotations

import uuid
from collections.abc import Sequence

from rastrainer.study.ratings import RatingDomain, RatingForm, RatingStore


class RatingWork:
    """The replays of one rater, and the marks on the forms that are filled in for each.

    Every mark is stored when it is given, so that a rater can stop and resume at any time. `place`
    of the present replay, from 0, in the rater's order is all that the rater learns.
    """

    def __init__(
        self, store: RatingStore, rater: str, trial_ids: Sequence[str], forms: Sequence[RatingForm]
    ) -> None:
        """Resume at the first replay that is not rated."""
        self.trial_ids = tuple(trial_ids)
        self.forms = tuple(forms)
        self.place = 0
        self._store = store
        self._rater = rater
        self._marks = {trial_id: store.marks(rater, trial_id) for trial_id in self.trial_ids}
        self.go_to_next()

    @property
    def trial_id(self) -> str:
        """UUID of the present replay's trial, never to be shown."""
        return self.trial_ids[self.place]

    @property
    def numbers(self) -> dict[str, int]:
        """The number of the present replay, from 1, and of all, for sentences."""
        return {"number": self.place + 1, "count": len(self.trial_ids)}

    @property
    def marks(self) -> dict[str, int]:
        return self._marks[self.trial_id]

    @property
    def open_domain(self) -> tuple[RatingForm, RatingDomain] | None:
        """The first domain of the present replay without a mark; None if all have one."""
        return self._open_of(self.marks)

    @property
    def rated(self) -> int:
        return sum(self._open_of(marks) is None for marks in self._marks.values())

    def give(self, mark: int) -> None:
        if self.open_domain is not None:
            form, domain = self.open_domain
            self._store_mark(form, domain.name, mark)

    def undo(self) -> bool:
        names = {domain.name: form for form in self.forms for domain in form.domains}
        given = [domain for domain in self.marks if domain in names]
        if given:
            self._store_mark(names[given[-1]], given[-1], None)
        return bool(given)

    def go_to_next(self) -> bool:
        """Go to the next replay that is not rated, around the end; return whether there is one."""
        count = len(self.trial_ids)
        for step in range(count):
            place = (self.place + step) % count
            if self._open_of(self._marks[self.trial_ids[place]]) is not None:
                self.place = place
                return True
        return False

    def go_back(self) -> None:
        self.place = max(0, self.place - 1)

    def _open_of(self, marks: dict[str, int]) -> tuple[RatingForm, RatingDomain] | None:
        for form in self.forms:
            for domain in form.domains:
                if domain.name not in marks:
                    return form, domain
        return None

    def _store_mark(self, form: RatingForm, domain: str, mark: int | None) -> None:
        trial_id = self.trial_id
        self._store.give(str(uuid.uuid4()), self._rater, trial_id, form, domain, mark)
        self._marks[trial_id] = self._store.marks(self._rater, trial_id)
