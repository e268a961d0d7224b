"""The list of mutants cannot rot: every text is in its file once, every check exists."""

import ast
import shutil
from pathlib import Path

import pytest

from mjforage.physics.validation.all_checks import __all__ as rooms
from mjforage.physics.validation.known_checks import check_names
from tests.mutants import running
from tests.mutants.__main__ import _row, main
from tests.mutants.faults import ROOT, Mutant, mutants
from tests.mutants.kernels import COMPILER, COMPILING, interpreted
from tests.mutants.running import FAILED, Outcome

ALL = mutants()
BY_NAME = {mutant.name: mutant for mutant in ALL}
OF_THE_ISSUE = (
    *("wind-moment-sign", "oblique-head-wind", "load-mass", "load-drag", "circulation-off"),
    *("wander", "item-noise", "cross-gusts", "propeller-power", "mouth-reach", "touch-speed"),
    "item-contacts",
)


@pytest.mark.parametrize("mutant", ALL, ids=lambda mutant: mutant.name)
def test_the_text_is_in_its_file_once(mutant: Mutant) -> None:
    text = mutant.path().read_text(encoding="utf-8")
    assert text.count(mutant.old) == 1
    spoilt = text.replace(mutant.old, mutant.new)
    assert spoilt != text
    if mutant.file.endswith(".py"):
        ast.parse(spoilt)


@pytest.mark.parametrize("check", sorted({mutant.check for mutant in ALL}))
def test_the_check_exists(check: str) -> None:
    file, _, name = check.partition("::")
    if not name:
        assert rooms and check in check_names()
        return
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    assert name in [node.name for node in tree.body if isinstance(node, ast.FunctionDef)]


def test_there_are_forty_and_those_of_which_it_is_known_that_they_once_passed() -> None:
    assert len(ALL) >= 40
    assert set(OF_THE_ISSUE) <= BY_NAME.keys()


def test_the_page_has_them_all_and_all_are_caught() -> None:
    page = (ROOT / "docs" / "mutants.md").read_text("utf-8")
    rows = [line for line in page.splitlines() if line.startswith("| `")]
    assert rows == [_row(mutant, Outcome(FAILED, "")) for mutant in mutants()]


def test_a_copy_without_the_compiler_has_plain_kernels(tmp_path: Path) -> None:
    path = tmp_path / COMPILER
    path.parent.mkdir(parents=True)
    shutil.copy2(ROOT / COMPILER, path)
    interpreted(tmp_path)
    assert path.read_text(encoding="utf-8").count(f"    return function\n{COMPILING}") == 1
    path.write_text("", encoding="utf-8")
    with pytest.raises(ValueError, match="has no line"):
        interpreted(tmp_path)


def small(folder: Path, body: str) -> Mutant:
    """A mutant of a repository of one file and one test."""
    (folder / "tests").mkdir(parents=True)
    (folder / "sum.py").write_text("TWO = 1 + 1\n", encoding="utf-8")
    (folder / "tests" / "test_sum.py").write_text(f"import sum\n{body}", encoding="utf-8")
    return Mutant("sum", "a wrong sum", "sum.py", "1 + 1", "1 - 1", "tests/test_sum.py::test_sum")


@pytest.mark.parametrize(
    ("body", "verdict"),
    [
        ("def test_sum():\n    assert sum.TWO == 2\n", "caught"),
        ("def test_sum():\n    assert sum.TWO is not None\n", "SURVIVED"),
        ("def test_other():\n    assert sum.TWO == 2\n", "broke (4)"),
    ],
)
def test_a_mutant_is_caught_survives_or_breaks_and_leaves_no_trace(
    body: str, verdict: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copy = tmp_path / "copy"
    mutant = small(copy, body)
    monkeypatch.setattr(Mutant, "path", lambda self, root: root / self.file)
    before = (copy / "sum.py").stat().st_mtime_ns
    assert running.run_mutant(mutant, copy).verdict == verdict
    assert (copy / "sum.py").read_text(encoding="utf-8") == "TWO = 1 + 1\n"
    assert (copy / "sum.py").stat().st_mtime_ns == before


def test_a_name_that_is_none_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["mutants", "wandr"])
    with pytest.raises(SystemExit, match="wandr unknown; --list names them"):
        main()
    monkeypatch.setattr("sys.argv", ["mutants", "--list", "wander"])
    main()
    assert capsys.readouterr().out == "wander: no wandering current (drawn-weather)\n"
