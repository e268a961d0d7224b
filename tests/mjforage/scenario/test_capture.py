import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from mjforage.base.errors import UserError
from mjforage.scenario.capture import (
    FROM_DEG,
    FROM_M,
    QUAYS,
    Capture,
    capture_text,
    load_capture,
    usual_capture,
)
from mjforage.scenario.vessel_files import capture_path, vessel_names, vessel_path

SHIPPED = load_capture("forager")


@pytest.fixture
def raft(tmp_path: Path) -> Path:
    """Somebody's own vessel file."""
    return Path(shutil.copy(vessel_path("forager"), tmp_path / "raft.toml"))


def put(vessel: Path, capture: Capture) -> None:
    capture_path(vessel).write_text(capture_text(capture, ["# for a test"]))


def test_the_model_lies_beside_the_vessel_by_name_and_by_file(raft: Path) -> None:
    assert capture_path("forager") == vessel_path("forager").with_name("forager.capture.toml")
    assert capture_path(raft) == raft.with_name("raft.capture.toml")
    assert not any("capture" in name for name in vessel_names())
    put(raft, SHIPPED)
    assert load_capture(str(raft)) == SHIPPED


def test_the_shipped_model_has_every_cell_and_hundreds_of_trials_in_each() -> None:
    assert len(SHIPPED.cells) == len(QUAYS) * len(FROM_M) * len(FROM_DEG)
    assert min(cell.trials for cell in SHIPPED.cells) >= 200


def test_a_hull_is_reckoned_by_its_own_trials_and_without_any_by_the_foragers(raft: Path) -> None:
    assert usual_capture(str(raft)) == SHIPPED
    own = replace(SHIPPED, period_s=20.0)
    put(raft, own)
    assert usual_capture(str(raft)) == own


def test_a_vessel_without_one_is_told_how_to_make_it(raft: Path) -> None:
    with pytest.raises(UserError) as caught:
        load_capture(str(raft))
    assert "no raft.capture.toml beside its file" in str(caught.value)
    assert f"mjforage calibrate {raft}" in str(caught.value)


def more_taken_than_tried(capture: Capture) -> Capture:
    first = replace(capture.cells[0], trials=3, taken=(2, 1, 1))
    return replace(capture, cells=(first, *capture.cells[1:]))


@pytest.mark.parametrize(
    ("spoilt", "words"),
    [
        (more_taken_than_tried, "4 taken of 3 trials"),
        (lambda c: replace(c, cells=c.cells[1:]), "cells are not every combination of quays"),
        (lambda c: replace(c, cells=(*c.cells, c.cells[0])), "cells are not every combination"),
        (lambda c: replace(c, follows=c.follows[:2]), "follows are not every kind of quays once"),
        (lambda c: replace(c, period_s=0.0), "period_s = 0.0 should be "),
        (
            lambda c: replace(c, cells=(replace(c.cells[0], taken=(1, 2)), *c.cells[1:])),
            "taken",
        ),
    ],
)
def test_a_file_that_cannot_be_is_refused_with_the_remedy(
    raft: Path, spoilt: Callable[[Capture], Capture], words: str
) -> None:
    put(raft, spoilt(SHIPPED))
    with pytest.raises(UserError) as caught:
        load_capture(str(raft))
    message = str(caught.value)
    assert message.startswith("raft.capture.toml: ") and words in message
    assert message.endswith(f"make it again: mjforage calibrate {raft}")
