"""Run folders made up by chance."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.mjforage.view.report.made_up_episodes import Plan
from tests.mjforage.view.report.made_up_runs import build


@pytest.fixture
def make_run(tmp_path: Path) -> Callable[..., Path]:
    """Return a builder of run folders; keywords are the fields of `Plan`."""

    def make(**settings: Any) -> Path:
        return build(tmp_path / f"run-{len(list(tmp_path.iterdir()))}", Plan(**settings))

    return make
