"""Make the draft of a head in a separate process, which knows MRML."""

from __future__ import annotations

import subprocess
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TextIO

from rastrainer.errors import InputError
from rastrainer.progress import HEAD_MADE, Progress, Warn, report_line
from rastrainer.python_environment import python_words
from rastrainer.scenario.writer import HeadDraft, read_draft

MAKE_HEAD = "rastrainer_headless.make_head"


class HeadProcess:
    """A process that makes the head, and then its skull while the head is already used."""

    def __init__(self, process: subprocess.Popen[str], errors: TextIO, folder: Path) -> None:
        """Keep the process, the file of its standard error and the folder of its draft."""
        self._process = process
        self._errors = errors
        self._folder = folder

    def head(self, progress: Progress, warn: Warn) -> HeadDraft:
        """Wait for the head and return its draft without a skull.

        Args:
            progress: called with each step's name and the share done; may raise to cancel.
            warn: called with each warning.

        Raises:
            InputError: there is no head in the volume.
        """
        assert self._process.stdout is not None  # It is a pipe.
        for line in self._process.stdout:
            if line.rstrip() == HEAD_MADE:
                return read_draft(self._folder)
            report_line(line.rstrip(), progress, warn)
        raise self._failure()

    def whole(self) -> HeadDraft:
        """Wait for the skull too, where one is wanted, and return the whole draft.

        Raises:
            InputError: there is no skull in the volume.
        """
        assert self._process.stdout is not None  # It is a pipe.
        self._process.stdout.read()
        if self._process.wait() != 0:
            raise self._failure()
        return read_draft(self._folder)

    def _failure(self) -> InputError:
        status = self._process.wait()
        self._errors.seek(0)
        lines = self._errors.read().strip().splitlines()
        return InputError(lines[-1] if lines else f"The head's process ended with {status}.")


@contextmanager
def head_process(volume: Path, options: list[str]) -> Iterator[HeadProcess]:
    """Yield a process that makes the head in a volume; it ends with the context.

    Args:
        volume: NRRD, NIfTI, or a folder of DICOM files.
        options: further arguments of `python -m rastrainer_headless.make_head`.
    """
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / "draft"
        words = python_words(MAKE_HEAD, str(volume), "-o", str(folder), *options)
        with (
            tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as errors,
            subprocess.Popen(words, stdout=subprocess.PIPE, stderr=errors, text=True) as process,
        ):
            try:
                yield HeadProcess(process, errors, folder)
            finally:
                process.kill()
