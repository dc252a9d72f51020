"""The trainees of a study: their data, trials and curricula, and their deletion."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from rastrainer.commands import CommandName
from rastrainer.decision.drill_record import DrillRecord
from rastrainer.errors import InputError
from rastrainer.json_records import record_to_json
from rastrainer.slicer.background_work import CancelableUntilBegun, inBackground
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.signal import Listening, Signal
from rastrainer.slicer.translation import _
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.curriculum.standing import CurriculumStanding
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import StoredTrial, Trainee, moment
from rastrainer.study_messages import CurriculumMessage
from rastrainer.work_progress import Progress, no_progress

if TYPE_CHECKING:
    from rastrainer.study.trainee_data import Erasure
    from rastrainer.study.tre_calibration import TreCalibration

T = TypeVar("T")

LOOK_EVERY_S = 1.0
NOBODY = _("Choose a trainee in the section Trainees first.")


class TraineeLogic:
    """Trainees of a study, which is opened when it is first needed.

    `changed` emits nothing whenever trainees or their trials may have changed. `chosen` is the
    pseudonym of the chosen trainee, empty if none is.
    """

    def __init__(
        self,
        openStudy: Callable[[], Study],
        records: Path,
        openPatiently: Callable[[], Study] | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """`openPatiently` opens the study in any thread, which may wait for a lock."""
        self.changed = Signal()
        self.chosen = ""
        self._openStudy, self._openPatiently = openStudy, openPatiently or openStudy
        self._records = records
        self._study: Study | None = None
        self._clock = clock
        self._lastLook = clock()
        self._version: int | None = None

    @property
    def study(self) -> Study:
        if self._study is None:
            self._study = self._openStudy()
            self._version = self._study.database.version()
        return self._study

    def reopen(self) -> None:
        """Continue with the study that is to be opened now, such as another file."""
        self.close()
        self.chosen = ""
        self.changed.emit()

    def close(self) -> None:
        """Close the study; it is opened again when it is needed."""
        if self._study is not None:
            self._study.close()
            self._study = self._version = None

    def hasChangedElsewhere(self) -> bool:
        """Check, about once a second, whether another program has changed the study.

        Another Slicer may work with the same file; this does not wait for it.
        """
        now = self._clock()
        if self._study is None or now - self._lastLook < LOOK_EVERY_S:
            return False
        self._lastLook = now
        version, before = self._study.database.version(), self._version
        self._version = version or before
        return version is not None and version != before

    def required(self) -> str:
        """Return the pseudonym of the chosen trainee; refuse to go on if none is chosen."""
        if not self.chosen:
            raise InputError(NOBODY)
        return self.chosen

    def trainees(self, archived: bool = False) -> tuple[Trainee, ...]:
        others = self.study.trainees(archived=True) if archived else ()
        return (*self.study.trainees(), *others)

    def choose(self, pseudonym: str) -> None:
        if pseudonym != self.chosen:
            self.chosen = pseudonym
            self.changed.emit()

    def chosenTrainee(self) -> Trainee | None:
        """Return the chosen trainee; None if none is chosen, or no longer exists."""
        known = {trainee.pseudonym: trainee for trainee in self.trainees(archived=True)}
        return known.get(self.chosen)

    def create(self, pseudonym: str, consent: bool) -> Trainee:
        """Add a trainee, under the next free pseudonym where none is given, and choose them."""
        trainee = self.study.create_trainee(pseudonym.strip() or None, consent)
        self.chosen = trainee.pseudonym
        self.changed.emit()
        return trainee

    def change(self, **changes: bool) -> None:
        self.study.change_trainee(self.chosen, **changes)
        self.changed.emit()

    def delete(self, progress: Progress = no_progress) -> Erasure:
        """Delete the chosen trainee with all trials and journals, for good; return their numbers.

        `progress` is called with a step once something is deleted, and may cancel until then.
        """
        from rastrainer.study.trainee_data import erase_trainee

        name = self.chosen
        cancelable = CancelableUntilBegun(progress)

        def erase(report: Progress) -> Erasure:
            records = self._records if self._records.is_dir() else None
            with self._openPatiently() as study:
                # It waits here while another program has the study locked.
                study.trainee(name)
                cancelable.begin()
                report(_("Deleting {name}").format(name=name), 0.0)
                return erase_trainee(study, name, records)

        erased = inBackground(erase, cancelable.progress)
        if self.chosen == name:
            self.chosen = ""
        self.changed.emit()
        return erased

    def inStudy(self, do: Callable[[Study], T], progress: Progress = no_progress) -> T:
        """Return what `do` returns, in the background, where it may wait for a lock."""

        def work(_report: Progress) -> T:
            with self._openPatiently() as study:
                return do(study)

        return inBackground(work, progress)

    def history(self) -> tuple[StoredTrial, ...]:
        return self.study.history(self.chosen) if self.chosenTrainee() else ()

    def results(self) -> Sequence[tuple[str, StoredTrial | DrillRecord]]:
        """Return the trials with their numbers, and the drills without, in order of starting."""
        found: list[tuple[str, StoredTrial | DrillRecord]] = [
            (str(number), trial) for number, trial in enumerate(self.history(), start=1)
        ]
        drills = self.study.drills(self.chosen) if self.chosenTrainee() else ()
        found += [("", drill) for drill in drills]
        return sorted(found, key=lambda each: moment(each[1].record.started_utc))


def calibration(study: Study) -> TreCalibration:
    """Return true and expected TRE of all trials of the study, of all trainees."""
    from rastrainer.study.study_data import trial_rows
    from rastrainer.study.tre_calibration import calibration_of

    everyone = study.trainees(archived=None)
    histories = (study.history(trainee.pseudonym) for trainee in everyone)
    return calibration_of(row for history in histories for row in trial_rows(history))


class CurriculumLogic(Listening):
    """Sets curricula, and follows the trainees through them.

    The simulator is sent each trainee's progress, also of those not chosen here, whenever that is
    new; everything is computed from the study, so that nothing is lost when either side ends.
    """

    def __init__(self, trainees: TraineeLogic, link: Link) -> None:
        self.changed = Signal()
        self._trainees = trainees
        self._link = link
        self._sent: dict[str, CurriculumMessage] = {}
        self._standings: dict[str, CurriculumStanding | None] = {}
        self._stamps: dict[str, tuple[Study, tuple[int | None, ...] | None]] = {}
        super().__init__(
            (trainees.changed, self._followTrainees),
            # The simulator may know nothing yet.
            (link.opened, self._sent.clear),
            (link.opened, self._followTrainees),
        )

    def standing(self) -> CurriculumStanding | None:
        return self._standings.get(self._trainees.chosen)

    def standings(self) -> Mapping[str, CurriculumStanding]:
        """Return the standing of each active trainee with a curriculum, by pseudonym."""
        return {name: found for name, found in sorted(self._standings.items()) if found}

    def choose(self, curriculum: Curriculum | None, isForEverybody: bool) -> None:
        """Have the chosen trainee, or everybody, follow a curriculum, or none, from now on."""
        name = "" if isForEverybody else self._trainees.required()
        CurriculumStore(self._trainees.study).choose(curriculum, name)
        self._followTrainees()

    def _followTrainees(self) -> None:
        """Send the standings that have changed, or everybody's in another study."""
        # The section Trainees shows the error.
        with contextlib.suppress(InputError):
            study = self._trainees.study
            store = CurriculumStore(study)
            stamps = store.stamps()
            for name in sorted(self._stamps.keys() | stamps.keys()):
                stamp = study, stamps.get(name)
                if self._stamps.get(name) != stamp:
                    self._standings[name] = store.standing(name) if name in stamps else None
                    self._stamps[name] = stamp
                standing, nothing = self._standings[name], CurriculumMessage(name)
                message = nothing if standing is None else standing.message(name)
                if self._sent.get(name, nothing) != message:
                    self._sent[name] = message
                    # Without a connection nothing is sent; a new connection gets everything.
                    self._link.send(CommandName.CURRICULUM, record_to_json(message))
        self.changed.emit()
