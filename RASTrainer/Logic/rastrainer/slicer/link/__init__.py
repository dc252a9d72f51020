"""The link to the simulator: connector, commands, heartbeat and recognition of the peer."""
