"""The simulator's OpenIGTLink side: the server, what it publishes, the commands it answers."""
