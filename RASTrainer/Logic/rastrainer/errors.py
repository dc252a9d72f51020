"""Errors for users: each message is one sentence that says what the user needs to do.

Readers of files, messages and arguments raise `InputError` if the input is unusable; a docstring
says so only if that surprises.
"""


class RASTrainerError(Exception):
    """An error that a user can understand and act on."""


class InputError(RASTrainerError, ValueError):
    """An unusable file, message or argument; the command line exits with status 2."""
