"""OpenIGTLink on the wire: messages, their contents, a reader of byte streams and a plain client.

Standard library only, so that both the simulator and Slicer's side can use it. The byte layouts
follow the OpenIGTLink protocol, versions 1 and 2 of the header.
"""
