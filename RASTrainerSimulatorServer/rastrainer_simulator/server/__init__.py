"""The programs that serve: the simulator and the replay of a trial."""
