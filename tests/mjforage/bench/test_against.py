"""Two checkouts beside each other."""

from pathlib import Path

import pytest

from mjforage.base.errors import UserError
from mjforage.bench.against import against
from mjforage.bench.slice_worker import NAMES

HERE = Path(__file__).resolve().parents[3]


def test_a_checkout_beside_itself_is_measured_in_slices() -> None:
    measured: list[str] = []
    names = ("hashing", "random, 2 episodes")
    pairs = against(HERE, slices=2, seconds=0.01, progress=measured.append, names=names)
    assert tuple(measured) == names
    assert [pair.name for pair in pairs] == list(names)
    for pair in pairs:
        assert min(pair.ours, pair.theirs) > 0.0
        assert pair.low <= pair.ratio <= pair.high
    assert set(names[:1]) < set(NAMES)


def test_what_is_no_checkout_and_too_few_slices_are_refused(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="is no checkout of mjforage"):
        against(tmp_path)
    with pytest.raises(UserError, match="--slices 1: give at least 2"):
        against(HERE, slices=1)


def test_a_checkout_that_cannot_be_imported_is_one_error(tmp_path: Path) -> None:
    for name in ("mjforage", "mjforage/runs"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "__init__.py").touch()
    (tmp_path / "mjforage" / "runs" / "evaluate.py").write_text("import there_is_no_such_thing\n")
    with pytest.raises(UserError, match="cannot run 'hashing'; its own message stands above"):
        against(tmp_path, slices=2, seconds=0.01, names=("hashing",))
