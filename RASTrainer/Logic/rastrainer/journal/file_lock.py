"""Keep two programs from writing to one file at the same time."""

from __future__ import annotations

import sys

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
