"""Command for completion in a shell."""

import sys
from typing import Literal

from mjforage.cli.console import app


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
