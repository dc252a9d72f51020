"""The OpenIGTLink server."""
