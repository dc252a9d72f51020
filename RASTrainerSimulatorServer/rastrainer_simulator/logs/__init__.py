"""What the simulator writes about its own running: files of JSON lines that never grow too big."""
