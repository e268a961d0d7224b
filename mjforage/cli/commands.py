"""The app with all of its commands: each module adds its own to it."""

from mjforage.cli import (
    compiling,  # noqa: F401
    completing,  # noqa: F401
    drawing,  # noqa: F401
    exporting,  # noqa: F401
    hulls,  # noqa: F401
    lists,  # noqa: F401
    placing,  # noqa: F401
    run_folders,  # noqa: F401
    schemas,  # noqa: F401
    speeds,  # noqa: F401
    studying,  # noqa: F401
    train,  # noqa: F401
    validating,  # noqa: F401
)
from mjforage.cli.console import app

__all__ = ["app"]
