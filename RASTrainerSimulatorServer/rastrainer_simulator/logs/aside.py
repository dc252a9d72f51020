"""A log handler in a thread of its own: whoever does not read the log holds nobody up.

A pipe whose reader has stopped, a terminal in which text is being selected and a disk that has gone
to sleep all make a write wait, and a server that waits answers nobody.
"""

from __future__ import annotations

import contextlib
import logging
import queue
import threading

MOST_WAITING = 1000
LAST_WORDS_S = 1.0


class Aside(logging.Handler):
    """Hands records to another handler, in order; those that it cannot take in time are lost."""

    def __init__(self, handler: logging.Handler) -> None:
        """`handler` belongs to it from now on; its level counts."""
        super().__init__(handler.level)
        self._handler = handler
        self._waiting: queue.Queue[logging.LogRecord | None] = queue.Queue(MOST_WAITING)
        self._thread = threading.Thread(target=self._write, name="log", daemon=True)
        self._thread.start()

    def emit(self, record: logging.LogRecord) -> None:
        """Put a record into the queue, or lose it where that is full."""
        with contextlib.suppress(queue.Full):
            self._waiting.put_nowait(record)

    def close(self) -> None:
        """Write what waits, for at most a second."""
        with contextlib.suppress(queue.Full):
            self._waiting.put(None, timeout=LAST_WORDS_S)
        self._thread.join(LAST_WORDS_S)
        if not self._thread.is_alive():
            self._handler.close()
        super().close()

    def _write(self) -> None:
        while (record := self._waiting.get()) is not None:
            self._handler.handle(record)
