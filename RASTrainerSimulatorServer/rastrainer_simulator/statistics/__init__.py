"""Paired tests, learning and clusters, without any knowledge of trials.

`import scipy` is cheap: scipy imports each of its parts at the first use.
"""
