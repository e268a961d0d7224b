"""Errors that a user can mend: each names the thing, the value and the remedy."""


class UserError(Exception):
    """Bad input or a bad environment; the command line prints it as one line and exits with 2."""
