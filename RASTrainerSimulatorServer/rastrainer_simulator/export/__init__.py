"""What leaves a study for other programs beside its tables: Motion-BIDS, xAPI, Slicer's files."""
