"""Units: meters inside the simulator; millimeters on the wire, in Slicer and in files."""

MM_PER_M = 1000.0
