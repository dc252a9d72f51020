"""The server of the views, over HTTP and WebSocket, and what both say to each other."""
