"""A study as a printable page: tables, charts, tests, limits, methods."""
