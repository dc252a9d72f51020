"""The study's statements, as PostgreSQL takes them."""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Sequence
from typing import Any

from rastrainer.study.database.connection import Rows

_JSON_EXTRACT = re.compile(r"json_extract\((\w+), '\$\.([\w.]+)'\)")


class PostgresStatements:
    """Gives PostgreSQL the statements of a study."""

    def __init__(self, connection: Any) -> None:
        self._connection = connection

    def execute(self, sql: str, parameters: Sequence[Any] = (), /) -> Rows:
        """Execute a statement with `?` for each parameter."""
        return self._connection.execute(portable_to_postgres(sql), parameters)

    def executemany(self, sql: str, parameters: Iterable[Sequence[Any]], /) -> None:
        """Execute a statement for each of several sequences of parameters."""
        with self._connection.cursor() as cursor:
            cursor.executemany(portable_to_postgres(sql), parameters)


@functools.cache
def portable_to_postgres(sql: str) -> str:
    """Return a statement with PostgreSQL's marks of parameters and way into JSON."""
    sql = _JSON_EXTRACT.sub(
        lambda found: f"({found[1]}::json #>> '{{{found[2].replace('.', ',')}}}')", sql
    )
    return sql.replace("%", "%%").replace("?", "%s")
