"""The files of finished tutorials beside the journals: who has learned which device."""

from __future__ import annotations

import contextlib
import json
import uuid
from collections import defaultdict
from datetime import datetime, timezone
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.files.json_fields import read_fields
from rastrainer.files.reading import failure_reason
from rastrainer.files.writing import keep_others_out, make_private_folder, write_text
from rastrainer.journal.folder import TUTORIAL_SUFFIX
from rastrainer_simulator.input.inputs import SourceKind
from rastrainer_simulator.ops.stamps import file_stamp, iso
from rastrainer_simulator.record.tutorial_outcome import TutorialOutcome

_COUNTS_FOR = {
    kind.value: (kind.value, SourceKind.KEYBOARD.value)
    for kind in (SourceKind.GAMEPAD, SourceKind.MOUSE)
}
"""Keys also type an ID and go through menus: who has learned another device may come with them."""


class FinishedTutorials:
    """Knows the devices that each trainee has finished the tutorial with."""

    def __init__(self, records: Path) -> None:
        """Look through the folder; a file that cannot be used counts for nothing."""
        self._records = records
        self._devices: dict[str, set[str]] = defaultdict(set)
        self._latest: dict[str, TutorialOutcome] = {}
        for path in sorted(records.glob(f"*{TUTORIAL_SUFFIX}")):
            with contextlib.suppress(InputError, OSError):
                self._note(TutorialOutcome.of(read_fields(path)))

    def has_done(self, trainee: str, device: SourceKind) -> bool:
        """Return whether a trainee has learned what they now use."""
        return device.value in self._devices.get(trainee, ())

    def latest(self, trainee: str) -> TutorialOutcome | None:
        """Return a trainee's latest finished tutorial."""
        return self._latest.get(trainee)

    def keep(self, outcome: TutorialOutcome) -> None:
        """Count a finished tutorial, and write its file.

        Raises:
            InputError: it cannot be written; it counts until the simulator ends.
        """
        self._note(outcome)
        utc = iso(datetime.now(timezone.utc))
        path = self._records / f"{file_stamp(utc)}_{uuid.uuid4()}{TUTORIAL_SUFFIX}"
        try:
            make_private_folder(self._records)
        except OSError as error:
            raise InputError(
                f"The folder {self._records} cannot be made: {failure_reason(error)}."
            ) from None
        # One line, as a journal's first: by it the file is found when the trainee is deleted.
        write_text(path, json.dumps({"utc": utc, **outcome.to_json()}) + "\n")
        keep_others_out(path)

    def _note(self, outcome: TutorialOutcome) -> None:
        self._devices[outcome.trainee].update(_COUNTS_FOR.get(outcome.device, (outcome.device,)))
        self._latest[outcome.trainee] = outcome
