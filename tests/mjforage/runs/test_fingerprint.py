"""The hash of a user's code: of all files of a package, of a lone module alone."""

import importlib
from pathlib import Path

import pytest

from mjforage.mission.scoring import Metric
from mjforage.runs.fingerprint import Code, our_code, outside_code


def code_of(name: str) -> Code:
    importlib.invalidate_caches()
    made = importlib.import_module(name).Mine
    outside_code.cache_clear()
    return outside_code(made)


def test_a_package_counts_whole_and_a_module_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "printed_one.py").write_text("class Mine: pass")
    (tmp_path / "printed_two").mkdir()
    (tmp_path / "printed_two" / "__init__.py").touch()
    (tmp_path / "printed_two" / "deep.py").write_text("class Mine: pass")
    before = code_of("printed_one"), code_of("printed_two.deep")
    assert [list(one.hashes) for one in before] == [["printed_one"], ["printed_two"]]
    (tmp_path / "printed_two" / "beside.py").write_text("more = 1")
    after = code_of("printed_one"), code_of("printed_two.deep")
    assert before[0] == after[0] and before[1] != after[1]


def test_ours_is_one_hash_which_training_has_of_its_own() -> None:
    assert outside_code(Metric) == Code({}, {})
    playing, training = our_code(("mujoco",)), our_code(learning=True)
    assert list(playing.hashes) == list(training.hashes) == ["mjforage"]
    assert playing.hashes != training.hashes
    assert list(playing.versions) == ["mujoco", "numba", "numpy", "scipy"]
