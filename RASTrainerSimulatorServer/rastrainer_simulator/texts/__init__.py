"""Everything that the simulator says to people, one table a language."""
