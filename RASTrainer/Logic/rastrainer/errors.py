"""The errors that a user is meant to read: each is one sentence that says what would be right."""


class RASTrainerError(Exception):
    """Something that the user can understand and act on."""


class InputError(RASTrainerError, ValueError):
    """A file, message or argument that cannot be used; the command line exits with status 2."""
