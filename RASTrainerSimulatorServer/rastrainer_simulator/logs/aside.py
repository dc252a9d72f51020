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
    """Hands records to another handler, in order.

    Those that it cannot take in time are lost; how many is told where they would have stood.
    """

    def __init__(self, handler: logging.Handler) -> None:
        """`handler` belongs to it from now on; its level counts."""
        super().__init__(handler.level)
        self._handler = handler
        self._waiting: queue.Queue[logging.LogRecord | None] = queue.Queue(MOST_WAITING)
        self._lost = 0
        self._thread = threading.Thread(target=self._write, name="log", daemon=True)
        self._thread.start()

    def emit(self, record: logging.LogRecord) -> None:
        """Put a record into the queue, or lose it where that is full."""
        try:
            if self._lost:
                self._waiting.put_nowait(_gap(self._lost))
                self._lost = 0
            self._waiting.put_nowait(record)
        except queue.Full:
            self._lost += 1

    def close(self) -> None:
        """Write what waits, for at most a second."""
        with contextlib.suppress(queue.Full):
            if self._lost:
                self._waiting.put(_gap(self._lost), timeout=LAST_WORDS_S)
            self._waiting.put(None, timeout=LAST_WORDS_S)
        self._thread.join(LAST_WORDS_S)
        if not self._thread.is_alive():
            self._handler.close()
        super().close()

    def _write(self) -> None:
        while (record := self._waiting.get()) is not None:
            self._handler.handle(record)


def _gap(lost: int) -> logging.LogRecord:
    words = "%d lines are missing here: nobody took them in time."
    return logging.LogRecord(__name__, logging.WARNING, __file__, 0, words, (lost,), None)
