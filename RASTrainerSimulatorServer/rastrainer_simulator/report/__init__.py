"""A study as a printable page: answers, tables, charts, tests, limits, methods.

`report.py` puts the page together out of its sections, one or a few in each file: what they compute
is here, their words are in `templates`, and `charts.py` draws.
"""
