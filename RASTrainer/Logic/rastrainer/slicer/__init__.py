"""Slicer's side: what works on MRML nodes, in desktop Slicer and without it, and needs no Qt.

Functions, methods and variables are in camelCase throughout, as in Slicer; names from the domain
keep their snake_case.
"""
