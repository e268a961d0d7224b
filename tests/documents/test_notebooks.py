"""The notebooks of docs/ as they are kept; `make docs` runs them."""

import re
from pathlib import Path

import nbformat
import pytest

from tests.documents.blocks import REPOSITORY

NOTEBOOKS = sorted((REPOSITORY / "docs" / "notebooks").glob("*.ipynb"))


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_kept_without_outputs_and_places(notebook: Path) -> None:
    book = nbformat.read(notebook, as_version=4)  # type: ignore[no-untyped-call]
    nbformat.validate(book)
    cells = [cell for cell in book.cells if cell.cell_type == "code"]
    assert not any(cell.outputs or cell.execution_count for cell in cells)
    assert book.metadata.kernelspec.name == "python3"
    assert not re.search(r"/(home|root|tmp|work|Users)/", notebook.read_text("utf-8"))


def test_the_page_of_notebooks_names_all() -> None:
    page = (REPOSITORY / "docs" / "notebooks" / "index.md").read_text("utf-8")
    assert [path.stem for path in NOTEBOOKS if f"({path.name})" not in page] == []
