"""Makes a closed surface for the simulator out of a volume of a patient's head.

Needs VTK, numpy and scipy, which Slicer brings along. Only `volume` knows MRML; the rest works on
arrays.
"""
