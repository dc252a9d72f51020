"""Exports of a study for other programs: Motion-BIDS, xAPI, Slicer's files, grades."""
