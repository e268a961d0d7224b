"""The command line in this process, as tests of the package have it."""

from tests.mjforage.conftest import command

__all__ = ["command"]
