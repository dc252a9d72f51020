"""A recorded trial shown again in the simulator's views."""
