"""Errors for users: each message is one sentence that says what is needed.

Whatever reads a file, a message or an argument raises `InputError` where it is not usable; its
docstring says so only if that surprises.
"""


class RASTrainerError(Exception):
    """An error that a user can understand and act on."""


class InputError(RASTrainerError, ValueError):
    """An unusable file, message or argument; the command line exits with status 2."""
