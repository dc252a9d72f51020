"""What PostgreSQL reports, as sentences; none holds a password, nor what somebody has entered."""

from __future__ import annotations

from typing import Any

from rastrainer.errors import InputError
from rastrainer.study.database.address import PostgresAddress
from rastrainer.study.database.database import StudyAwayError, StudyBusyError

_LOCKED = ("55P03", "57014", "40P01", "40001")
"""A lock, or a statement, that took too long; two that wait for each other."""
_LEFT = "25P03"
"""The server has ended a change that this program did not go on with, such as a computer asleep."""
_OURS = ("23", "42")
"""Classes of errors that only a mistake of ours makes."""
_MAX_WORDS = 200

_BY_STATE = {
    "22": "The study holds a value that RASTrainer did not write, or was to store one.",
    "25006": "The study {0} is read-only.",
    "28": "The server of {0} refuses this user; check name, ~/.pgpass and pg_hba.conf.",
    "3D000": "The server of {0} has no such database; its administrator creates it.",
    "42501": "The user may not do this in {0}; make it the owner of the database.",
    "42P01": "The study {0} is damaged; restore it from a backup.",
    "42703": "The study {0} is damaged; restore it from a backup.",
    "53100": "The study {0} cannot be written: the disk of its server is full.",
    "XX": "The study {0} is damaged; restore it from a backup.",
    "58": "The study {0} cannot be read or written: the disk of its server fails.",
}
_BY_WORDS = {
    "password authentication failed": _BY_STATE["28"],
    "no password supplied": (
        "The server of {0} asks for a password; put it into ~/.pgpass, readable by you alone."
    ),
    "pg_hba.conf": _BY_STATE["28"],
    "root certificate file": (
        "To check the certificate of {0}, its issuer's is needed: put it into "
        "~/.postgresql/root.crt, or name its file with sslrootcert."
    ),
    "certificate verify failed": (
        "The certificate of {0} is not the one of its issuer: somebody else may be answering."
    ),
    "does not match host name": (
        "The certificate of {0} is another computer's: somebody else may be answering."
    ),
    "does not support ssl": (
        "The server of {0} does not offer TLS, which a study on another computer needs; its "
        "administrator switches ssl on."
    ),
    '" does not exist': "The server of {0} has no such database or user.",
    "permissions should be": (
        "A file of keys or passwords for {0} can be read by others; make it yours with chmod 600."
    ),
}


def postgres_error(error: Any, address: PostgresAddress) -> InputError | None:
    """Return what to tell the user of an error of psycopg; None where the mistake is ours."""
    state, text = error.sqlstate or "", str(error).lower()
    if state in _LOCKED:
        return StudyBusyError(
            f"Another program has the study {address} locked; try again when it has finished."
        )
    if state == _LEFT:
        return StudyBusyError(
            f"The study {address} waited too long for this program, and nothing has changed; try "
            "again."
        )
    for sentences, found in ((_BY_STATE, state.startswith), (_BY_WORDS, text.__contains__)):
        for key, sentence in sentences.items():
            if found(key):
                return InputError(sentence.format(address))
    if state.startswith(_OURS):
        return None
    is_about_the_link = "OperationalError" in {each.__name__ for each in type(error).__mro__}
    if not is_about_the_link:
        return InputError(_BY_STATE["22"]) if "nul (0x00)" in text else None
    return StudyAwayError(
        f"The study {address} cannot be reached now. ({' '.join(text.split())[:_MAX_WORDS]})"
    )
