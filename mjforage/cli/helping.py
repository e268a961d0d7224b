"""Commands about the commands: help, and completion in a shell."""

import sys
from typing import Literal

from mjforage.cli.console import app


@app.command(name="help")
def help_of(*command: str) -> None:
    """Show the help of a command, as its --help; without one, list the commands.

    Parameters
    ----------
    command
        Name of a command, such as evaluate, or study board.
    """
    app([*command, "--help"], exit_on_error=False, print_error=False)


@app.command
def completion(shell: Literal["bash", "zsh", "fish"], /) -> None:
    """Print the script by which a shell completes commands and flags.

    Parameters
    ----------
    shell
        bash, zsh or fish. For bash: `mjforage completion bash >
        ~/.local/share/bash-completion/completions/mjforage`, then open a new shell.
    """
    sys.stdout.write(app.generate_completion(shell=shell))
