"""An empty folder to work in, and a finished run there."""

from collections.abc import Iterator
from contextlib import nullcontext
from pathlib import Path

import pytest

from tests.mjforage.cli.spoiling import SHORT, outcome


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """Work in an empty folder, and save no figure, which takes seconds."""
    folder = tmp_path_factory.mktemp("bad")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr("mjforage.cli.console.told", lambda lines: nullcontext())
        patch.setattr("mjforage.bench.running.bench", lambda report: {})
        patch.setattr("mjforage.view.report.draw_figures", lambda logs: [])
        patch.setattr("mjforage.view.page.html.save_figure", lambda folder, picture: (b"", b""))
        yield folder


@pytest.fixture(scope="module")
def run(place: Path) -> Path:
    """Return a finished run, in the folder `run`."""
    assert outcome("evaluate", "--policy", "random", *SHORT, "--out", "run") == ""
    return place / "run"
