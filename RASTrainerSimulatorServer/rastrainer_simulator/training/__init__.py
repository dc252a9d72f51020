"""The trial: its phases, touches, instructions and ground truth."""
