"""Screens as data, events with sound and vibration, and the presenter that shows them."""
