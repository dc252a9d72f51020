"""A study as a printable page: answers, tables, charts, tests, limits, methods.

`report.py` puts the page together out of its sections, one or a few in each file: the modules
compute, `templates` has the words, and `charts.py` draws.
"""
