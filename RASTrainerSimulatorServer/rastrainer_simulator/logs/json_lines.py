"""One log record as one line of JSON."""

from __future__ import annotations

import json
import logging
from datetime import datetime, timezone

from rastrainer_simulator.record.stamps import iso

LONGEST_MESSAGE = 8000
"""Characters of a message or a traceback; what is longer is cut."""


class JsonLines(logging.Formatter):
    """Formats a record as `{"utc": …, "level": …, "logger": …, "message": …}`.

    What was passed as `extra={"data": {…}}` stands under `data`, a traceback under `traceback`.
    """

    def format(self, record: logging.LogRecord) -> str:
        """Return the line, without a newline."""
        line = {
            "utc": iso(datetime.fromtimestamp(record.created, timezone.utc)),
            "level": record.levelname.lower(),
            "logger": record.name,
            "process": record.process,
            "message": record.getMessage()[:LONGEST_MESSAGE],
        }
        data = getattr(record, "data", None)
        if data is not None:
            line["data"] = data
        if record.exc_info:
            line["traceback"] = self.formatException(record.exc_info)[-LONGEST_MESSAGE:]
        return json.dumps(line, default=str)
