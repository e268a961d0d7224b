"""The command line: one function per command, thin over the library.

Nothing else is imported here, so that Ctrl-C is understood before all else is.
"""

from collections.abc import Sequence

from mjforage.base.interrupted import ctrl_c_kept


def main(arguments: Sequence[str] | None = None) -> None:
    """Entry point: one clear line and exit code 2 for everything that a user can mend, 130 for
    Ctrl-C.
    """
    with ctrl_c_kept() as interrupted:
        from mjforage.cli.running import run

        run(arguments, interrupted)
