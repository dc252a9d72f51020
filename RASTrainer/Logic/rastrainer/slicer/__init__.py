"""Slicer's side: what works on MRML nodes, in desktop Slicer and without it, and needs no Qt."""
