"""The public names: lazily imported, documented with examples that run, and no more than those."""

import doctest
import inspect
import json
import subprocess
import sys
from pathlib import Path

import pytest

import mjforage as mf

PAGE = Path(__file__).parents[3] / "docs" / "python.md"
HEAVY = ("numba", "scipy", "polars", "matplotlib", "mujoco", "torch", "pydantic", "joblib", "rich")


def test_the_import_loads_nothing_heavy() -> None:
    code = "import json, sys, mjforage; print(json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True)
    loaded = set(json.loads(done.stdout))
    assert loaded.isdisjoint(HEAVY)
    assert {name for name in loaded if name.startswith("mjforage.api")} == set()


def test_every_name_is_there_and_listed() -> None:
    assert len(mf.__all__) <= 20
    assert set(mf.__all__) <= set(dir(mf))
    for name in mf.__all__:
        assert getattr(mf, name).__name__ == name
    with pytest.raises(AttributeError, match="has no attribute 'evaluat'"):
        mf.evaluat  # noqa: B018


@pytest.mark.parametrize("name", mf.__all__)
def test_examples_of_docstrings_run(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    made = getattr(mf, name)
    found = doctest.DocTestFinder(recurse=False).find(made, name, globs={})
    examples = sum(len(one.examples) for one in found)
    assert examples, f"{name}: no example"
    assert inspect.getdoc(made)
    runner = doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    said: list[str] = []
    assert not sum(runner.run(one, out=said.append).failed for one in found), "".join(said)


def test_the_page_has_every_name() -> None:
    text = PAGE.read_text("utf-8")
    assert [name for name in mf.__all__ if f"`mf.{name}`" not in text] == []
