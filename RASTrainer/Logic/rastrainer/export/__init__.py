"""What leaves a study for other programs: tables, Motion-BIDS, xAPI, Slicer's files."""
