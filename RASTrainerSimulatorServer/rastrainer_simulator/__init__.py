"""The simulator: a virtual KUKA LBR iiwa 7 that a trainee drives and that Slicer listens to."""
