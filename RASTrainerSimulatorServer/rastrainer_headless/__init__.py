"""Slicer's part without Slicer, on slicer-core's MRML nodes: for demo, tests and heads."""
