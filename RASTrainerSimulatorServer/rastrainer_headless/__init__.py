"""Slicer's part without Slicer, on slicer-core's MRML nodes: for the demo and the tests."""
