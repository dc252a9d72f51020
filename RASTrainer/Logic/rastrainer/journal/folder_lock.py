"""File locks, and which simulator records in a folder: the one that holds the folder's lock.

The lock file describes the simulator. The lock ends with its process and is not inherited: while it
is held, that process is running.
"""

from __future__ import annotations

import contextlib
import json
import os
import sys
from dataclasses import asdict, dataclass
from pathlib import Path

from rastrainer.finite_json import decode_finite_json

if sys.platform == "win32":
    import msvcrt

    # Beyond the file's end, so that readers are not kept out.
    _FAR = 1 << 40

    def lock(descriptor: int) -> None:
        """Lock an open file until it is closed.

        Raises:
            OSError: another program holds the lock.
        """
        import os

        position = os.lseek(descriptor, 0, os.SEEK_CUR)
        os.lseek(descriptor, _FAR, os.SEEK_SET)
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        os.lseek(descriptor, position, os.SEEK_SET)

else:
    import fcntl

    def lock(descriptor: int) -> None:
        """Lock an open file until it is closed.

        Raises:
            OSError: another program holds the lock.
        """
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


LOCK_NAME = ".simulator.lock"
MAX_LOCK_BYTES = 4096
STARTED_BY = "RASTRAINER_STARTED_BY"
"""Environment variable: the program that starts a simulator."""


@dataclass(frozen=True)
class FolderHolder:
    """The simulator that holds a folder.

    Attributes:
        pid: of its process; 0 if unknown yet.
        started: UTC, ISO 8601.
        started_by: program that started it; empty if a person did.
        host: on which it listens for OpenIGTLink.
        port: its port; 0 if it does not listen.
        page: address of its page; empty if none.
    """

    pid: int = 0
    started: str = ""
    started_by: str = ""
    host: str = ""
    port: int = 0
    page: str = ""


def write_holder(descriptor: int, holder: FolderHolder) -> None:
    """Write the holder into the lock file, which is open and locked.

    Raises:
        OSError: it cannot be written.
    """
    content = json.dumps(asdict(holder)).encode("ascii")
    os.lseek(descriptor, 0, os.SEEK_SET)
    os.write(descriptor, content)
    os.ftruncate(descriptor, len(content))


def read_holder(folder: Path) -> FolderHolder | None:
    """Return the simulator that records in a folder, or None if none is known."""
    try:
        descriptor = os.open(folder / LOCK_NAME, os.O_RDWR | getattr(os, "O_BINARY", 0))
    except OSError:
        return None
    try:
        # For a moment: a simulator that starts just then tries again.
        lock(descriptor)
        return None
    except OSError:
        return read_open_holder(descriptor)
    finally:
        os.close(descriptor)


def read_open_holder(descriptor: int) -> FolderHolder:
    """Return the holder named in an open lock file."""
    with contextlib.suppress(OSError, ValueError, TypeError):
        os.lseek(descriptor, 0, os.SEEK_SET)
        said = decode_finite_json(os.read(descriptor, MAX_LOCK_BYTES).decode("ascii"))
        nobody = FolderHolder()
        known = {
            name: type(getattr(nobody, name))(said[name])
            for name in FolderHolder.__dataclass_fields__
            if name in said
        }
        return FolderHolder(**known)
    return FolderHolder()
