"""Slicer's side: what works on MRML nodes, in desktop Slicer and without it, and needs no Qt.

Functions, methods and variables are in camelCase throughout, as in Slicer; what they take from the
domain keeps its snake_case.
"""
