"""The sentences of the simulator's screens, one file a language."""
