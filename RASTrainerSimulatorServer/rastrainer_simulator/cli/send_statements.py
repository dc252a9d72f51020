"""`rastrainer send-statements STUDY`: trials to a learning record store, as they are stored."""

from __future__ import annotations

import argparse
import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.files.reading import printable_name, read_json, read_text
from rastrainer.files.writing import write_json
from rastrainer.json_checks import accepted
from rastrainer.number_text import counted
from rastrainer.study.database.database import path_beside_study
from rastrainer.study.study_data import read_study_data
from rastrainer_simulator.cli import arg
from rastrainer_simulator.cli.options import Subcommand
from rastrainer_simulator.export.xapi import statements
from rastrainer_simulator.net.record_store import (
    BATCH,
    RECORD_STORE_FILE,
    Delivery,
    RecordStore,
    StoreUnreachableError,
    home_page_url,
    read_record_store_settings,
)

CREDENTIALS_VARIABLE = "RASTRAINER_XAPI_CREDENTIALS"
FIRST_RETRY_S, LAST_RETRY_S = 2.0, 300.0
_OTHERS = 0o077
_MAX_CREDENTIALS, _MAX_SENT = 1_000, 64_000_000


class SentStatements:
    """Which statements a store has already; a file that is written after each request.

    A crash between request and file sends statements again, which the store recognizes by their
    UUIDs.
    """

    def __init__(self, study: Path, store: str, home_page: str) -> None:
        """Read what has been sent."""
        self.path = study.with_name(f"{study.name}.xapi-sent.json")
        self._key = f"{store} {home_page}"
        self._ids: dict[str, list[str]] = {}
        if self.path.exists():
            found = read_json(self.path, _MAX_SENT)
            if not isinstance(found, dict) or not all(map(_is_list_of_texts, found.values())):
                raise InputError(
                    f"{printable_name(self.path)} does not hold lists of UUIDs; delete it, and all "
                    "statements are sent again, which the store recognizes."
                )
            self._ids = found

    def missing(self, all_of_them: list[dict[str, Any]]) -> list[dict[str, Any]]:
        known = set(self._ids.get(self._key, ()))
        return [statement for statement in all_of_them if statement["id"] not in known]

    def note(self, delivery: Delivery) -> None:
        """Note what the store has now; what it refused is sent again with the next command."""
        self._ids.setdefault(self._key, []).extend([*delivery.stored, *delivery.differing])
        write_json(self.path, self._ids)


class Sender:
    """Sends the statements of a study, and reports the outcome."""

    def __init__(
        self,
        read: Callable[[], list[dict[str, Any]]],
        store: RecordStore,
        sent: SentStatements,
        pause: Callable[[float], None] = time.sleep,
    ) -> None:
        """Send nothing yet.

        Args:
            read: returns all statements of the study, as it is then.
            store: takes them.
            sent: what it has taken before.
            pause: waits for a time in s.
        """
        self._read, self._store, self._sent, self._pause = read, store, sent, pause
        self._refused: set[str] = set()

    def send(self) -> int:
        """Send once what is missing; return how many statements the store refused.

        Raises:
            StoreUnreachableError: the store does not answer.
            InputError: the study cannot be read, or the store accepts nothing.
        """
        missing = [each for each in self._sent.missing(self._read()) if self._is_not_refused(each)]
        for start in range(0, len(missing), BATCH):
            delivery = self._store.deliver(missing[start : start + BATCH])
            self._sent.note(delivery)
            self._refused |= set(delivery.refused)
            _tell(delivery)
        return len(self._refused)

    def watch(self, period_s: float) -> None:
        """Send repeatedly until the process is ended, waiting for an unreachable store."""
        retry_s = FIRST_RETRY_S
        while True:
            try:
                self.send()
            except StoreUnreachableError as error:
                print(f"{error} Nothing is lost; next try in {retry_s:g} s.", flush=True)
                self._pause(retry_s)
                retry_s = min(2.0 * retry_s, LAST_RETRY_S)
            else:
                retry_s = FIRST_RETRY_S
                self._pause(period_s)

    def _is_not_refused(self, statement: dict[str, Any]) -> bool:
        return statement["id"] not in self._refused


def run(arguments: argparse.Namespace) -> int:
    if arguments.watch is not None and not 1.0 <= arguments.watch <= 86_400.0:
        raise InputError("--watch must be from 1 to 86400 s.")
    settings = read_record_store_settings(arguments.config)
    address = arguments.store or settings.store
    if not address:
        raise InputError(
            f"Give the record store's address with --store, or as store in {RECORD_STORE_FILE}."
        )
    home_page = accepted(
        home_page_url, arguments.home_page or settings.home_page, "--home-page (homePage)"
    )
    store = RecordStore(address, _credentials(arguments.credentials or settings.credentials))

    def read() -> list[dict[str, Any]]:
        return statements(read_study_data(arguments.study, allow_incomplete=True), home_page)

    sent = SentStatements(path_beside_study(arguments.study), address, home_page)
    sender = Sender(read, store, sent)
    if arguments.watch is not None:
        sender.watch(arguments.watch)
    try:
        return 1 if sender.send() else 0
    except StoreUnreachableError as error:
        print(f"rastrainer: {error} Nothing is lost: run the command again.", file=sys.stderr)
        return 1


def _tell(delivery: Delivery) -> None:
    if delivery.stored:
        print(f"{counted(len(delivery.stored), 'statement')} stored", flush=True)
    for name in delivery.differing:
        print(f"{name}: the store has another version of this statement, and keeps it", flush=True)
    for name, reason in delivery.refused.items():
        print(f"{name}: refused by the store ({reason})", flush=True)


def _credentials(file: Path | None) -> str:
    if file is None:
        if CREDENTIALS_VARIABLE not in os.environ:
            raise InputError(
                f"Give name:password of the record store in {CREDENTIALS_VARIABLE}, or in a file "
                "with --credentials."
            )
        return os.environ[CREDENTIALS_VARIABLE]
    text = read_text(file, _MAX_CREDENTIALS)
    if os.name == "posix" and file.stat().st_mode & _OTHERS:
        raise InputError(
            f"Others can read {printable_name(file)}; restrict it to yourself with chmod 600."
        )
    return text.strip()


def _is_list_of_texts(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(each, str) for each in value)


COMMANDS = (
    Subcommand(
        "send-statements",
        "send a study's trials to a learning record store (xAPI)",
        run,
        (
            arg.study(),
            arg.option("--store", metavar="URL", help="of its xAPI endpoint (default: as set)"),
            arg.option(
                "--home-page",
                metavar="URL",
                help="of the lab's system; it makes pseudonyms and tasks unique (default: as set)",
            ),
            arg.path("--credentials", "FILE", "that only you can read"),
            arg.option(
                "--watch",
                type=float,
                metavar="S",
                help="keep sending new trials, looking for them every S seconds, until Ctrl-C",
            ),
            arg.path(
                "--config",
                "DIR",
                f"folder of your settings, in which {RECORD_STORE_FILE} may set the others",
            ),
        ),
        "Send a statement for each trial, aborted trial and questionnaire that the store does not "
        "have yet. Pseudonyms, results and times leave this computer; trainees who did not consent "
        "to research are left out. Name and password of the store are read from "
        f"{CREDENTIALS_VARIABLE} or a file, as name:password.",
    ),
)
