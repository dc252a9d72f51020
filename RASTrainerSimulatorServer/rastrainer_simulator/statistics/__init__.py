"""Paired tests, learning and clusters, without any knowledge of trials.

Of scipy, `import scipy` imports nearly nothing: each part is imported when it is first used.
"""
