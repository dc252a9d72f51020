"""The simulation: a pure, deterministic function of its state and the input. Start reading here."""
