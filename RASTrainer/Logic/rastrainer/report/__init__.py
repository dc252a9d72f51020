"""A study as a printable page: tables, charts, tests, limits, methods.

`report.py` puts the page together out of its sections, one or a few in each file, which are built
of `elements.py` and `comparisons.py`.
"""
