"""Locks on files, and which simulator records in a folder: it holds the folder's lock.

The lock file names the simulator. The lock ends with its process, however that ends, and no other
process inherits it: while it is held, the process that it names is running.
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
    """A simulator as others on its computer find it.

    Attributes:
        pid: of its process; 0 where it has not said yet who it is.
        started: UTC, ISO 8601.
        started_by: the program that has started it; empty where a person has.
        host: on which it listens for OpenIGTLink.
        port: there; 0 while, or because, it listens on none.
        page: address of its page; empty without.
    """

    pid: int = 0
    started: str = ""
    started_by: str = ""
    host: str = ""
    port: int = 0
    page: str = ""


def write_holder(descriptor: int, holder: FolderHolder) -> None:
    """Say in the lock, which is open and held, who holds it.

    Raises:
        OSError: it cannot be written.
    """
    content = json.dumps(asdict(holder)).encode("ascii")
    os.lseek(descriptor, 0, os.SEEK_SET)
    os.write(descriptor, content)
    os.ftruncate(descriptor, len(content))


def read_holder(folder: Path) -> FolderHolder | None:
    """Return who records in a folder; None where nobody does, or nobody whom we may know."""
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
    """Return who is named in a lock that is open."""
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
