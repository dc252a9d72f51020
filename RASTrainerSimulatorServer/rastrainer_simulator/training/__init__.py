"""The trial: its phases, its touches, what is said, and what is true."""
