"""What would have crashed Slicer in a test."""

from rastrainer_headless.connector import crashes


def take_crashes():
    """Return the crashes recorded since the last call."""
    taken = crashes[:]
    crashes.clear()
    return taken
