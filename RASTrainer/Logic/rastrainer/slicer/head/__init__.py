"""From a volume of a patient's head to a closed surface that the simulator can train on.

Needs VTK, numpy and scipy, which Slicer brings along. Only `volume` knows MRML; the rest works on
arrays.
"""
