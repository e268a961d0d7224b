"""Notebooks run in their folder, where they leave nothing."""

from pathlib import Path

from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.errors import ExtensionError
from sphinx.util.typing import ExtensionMetadata


def setup(app: Sphinx) -> ExtensionMetadata:
    """Compare the folder after all pages were read with what it is now."""
    folder = Path(app.srcdir, "notebooks")
    before = set(folder.iterdir())

    def compare(app: Sphinx, env: BuildEnvironment) -> None:
        if left := sorted(path.name for path in set(folder.iterdir()) - before):
            raise ExtensionError(f"notebooks leave {', '.join(left)} in {folder}")

    app.connect("env-updated", compare)
    return {"version": "1", "parallel_read_safe": True, "parallel_write_safe": True}
