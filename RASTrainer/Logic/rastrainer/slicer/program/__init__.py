"""The simulator as a program: its installation, its process and its end."""
