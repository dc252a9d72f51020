"""What leaves a study for other programs besides its tables: Motion-BIDS, xAPI, Slicer's files."""
