"""Errors that a user can mend: each names the thing, the value and the remedy."""


class UserError(Exception):
    """Bad input or a bad environment; the command line prints it as one line and exits with 2.

    Examples
    --------
    >>> import mjforage as mf
    >>> try:
    ...     mf.load_scenario("comb-prot")
    ... except mf.UserError as error:
    ...     print(str(error).split("; ")[1])
    did you mean comb-port?
    """


class WeightsError(UserError):
    """A weight file that is missing, of another kind, or made for something else."""


def printable(text: str) -> str:
    """A text with characters that no terminal can show, such as a NUL byte, escaped."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)
