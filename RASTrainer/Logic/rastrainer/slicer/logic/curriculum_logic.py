"""Curricula in Slicer: set for trainees, and told to the simulator, whose menus show them."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.protocol import CommandName
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.logic.trainee_logic import TraineeLogic
from rastrainer.slicer.signal import Listening, Signal
from rastrainer.slicer.translation import _
from rastrainer.study.curriculum.curriculum import Curriculum, read_curriculum
from rastrainer.study.curriculum.curriculum_message import CurriculumMessage
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.curriculum.standing import CurriculumStanding
from rastrainer.study.database.study import Study


class CurriculumLogic:
    """What the Curriculum panel does.

    The simulator is told where each trainee stands, also those not chosen here, whenever that is
    new; everything is computed from the study, so that nothing is lost when either side ends.

    Attributes:
        changed: emits nothing, whenever a curriculum or a standing may be another.
    """

    def __init__(self, trainees: TraineeLogic, link: Link) -> None:
        self.changed = Signal()
        self._trainees = trainees
        self._link = link
        self._told: dict[str, CurriculumMessage] = {}
        self._standings: dict[str, CurriculumStanding] = {}
        self._stamps: dict[str, tuple[int | None, ...]] = {}
        self._followed: Study | None = None
        self._listening = Listening(
            (trainees.changed, self._followTrainees), (link.opened, self._tellAll)
        )

    def close(self) -> None:
        """Stop listening."""
        self._listening.close()

    def standing(self) -> CurriculumStanding | None:
        """Return where the chosen trainee stands; None without a curriculum, or a trainee."""
        return self._standings.get(self._trainees.chosen)

    def standings(self) -> Mapping[str, CurriculumStanding]:
        """Return where each active trainee with a curriculum stands, by pseudonym."""
        return dict(sorted(self._standings.items()))

    def choose(self, path: Path, isForEverybody: bool) -> Curriculum:
        """Have the chosen trainee, or everybody, follow a file's curriculum from now on.

        Raises:
            InputError: the file is no curriculum, or nobody is chosen.
        """
        curriculum = read_curriculum(path)
        self._choose(curriculum, isForEverybody)
        return curriculum

    def end(self, isForEverybody: bool) -> None:
        """Have the chosen trainee, or everybody, follow no curriculum from now on.

        Raises:
            InputError: nobody is chosen.
        """
        self._choose(None, isForEverybody)

    def _choose(self, curriculum: Curriculum | None, isForEverybody: bool) -> None:
        name = "" if isForEverybody else self._trainees.chosen
        if not name and not isForEverybody:
            raise InputError(_("Choose a trainee in the section Trainees first."))
        CurriculumStore(self._trainees.study).choose(curriculum, name)
        self._followTrainees()

    def _tellAll(self) -> None:
        """Tell the simulator, which may know nothing yet, where everybody stands."""
        self._told.clear()
        self._stamps.clear()
        self._followTrainees()

    def _followTrainees(self) -> None:
        """Tell where those stand of whom something is new, or everybody in another study."""
        # The section Trainees shows what is wrong with the study.
        with contextlib.suppress(InputError):
            store = CurriculumStore(self._trainees.study)
            stamps = store.stamps()
            isSame = self._trainees.study is self._followed
            known = self._told.keys() | self._standings.keys()
            for name in sorted(known - stamps.keys()):
                self._tell(name, None)
            for name, stamp in stamps.items():
                if not isSame or self._stamps.get(name) != stamp:
                    self._tell(name, store.standing(name))
            self._stamps, self._followed = stamps, self._trainees.study
        self.changed.emit()

    def _tell(self, name: str, standing: CurriculumStanding | None) -> None:
        told = CurriculumMessage.of(name, standing)
        self._standings.pop(name, None)
        if standing is not None:
            self._standings[name] = standing
        if self._told.get(name, CurriculumMessage(name)) == told:
            return
        self._told[name] = told
        if standing is None:
            del self._told[name]
        # Without a connection nothing is sent; a new connection is told everything.
        self._link.send(CommandName.CURRICULUM, told.arguments())
