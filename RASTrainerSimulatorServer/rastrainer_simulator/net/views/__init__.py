"""The server of the views, over HTTP and WebSocket, and their messages."""
