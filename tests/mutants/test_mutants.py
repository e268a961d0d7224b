"""The list of mutants cannot rot: every text is in its file once, every check exists."""

import ast
import shutil
from pathlib import Path

import pytest

from tests.mjforage.physics.validation.measures import CHECKS
from tests.mjforage.physics.validation.table import MODULES
from tests.mutants import running
from tests.mutants.__main__ import main, page
from tests.mutants.faults import ROOT, Mutant, mutants
from tests.mutants.kernels import COMPILER, COMPILING, interpreted

ALL = mutants()
BY_NAME = {mutant.name: mutant for mutant in ALL}
OF_THE_ISSUE = (
    *("wind-moment-sign", "oblique-head-wind", "load-mass", "load-drag", "circulation-off"),
    *("wander", "item-noise", "cross-gusts", "propeller-power", "mouth-reach", "touch-speed"),
    "item-contacts",
)


@pytest.mark.parametrize("mutant", ALL, ids=lambda mutant: mutant.name)
def test_the_text_is_in_its_file_once(mutant: Mutant) -> None:
    path, spoilt = mutant.spoilt()
    assert spoilt != path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        ast.parse(spoilt)


@pytest.mark.parametrize("check", sorted({mutant.check for mutant in ALL}))
def test_the_check_exists(check: str) -> None:
    file, _, name = check.partition("::")
    name = name.partition("[")[0]
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    assert name in [node.name for node in tree.body if isinstance(node, ast.FunctionDef)]


def test_each_check_of_the_physics_notices_a_fault() -> None:
    file = "tests/mjforage/physics/validation/test_checks.py"
    checks = {f"{file}::test_check[{name}]" for name in CHECKS}
    assert MODULES and checks == {mutant.check for mutant in ALL if mutant.check.startswith(file)}


def test_all_rooms_have_some_and_those_that_once_passed_are_among_them() -> None:
    assert len(ALL) >= 40
    assert set(OF_THE_ISSUE) <= BY_NAME.keys()


def test_the_page_has_them_all() -> None:
    text = (ROOT / "docs" / "mutants.md").read_text("utf-8")
    assert text == page(ALL)


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
    check = "tests/test_sum.py::test_sum"
    return Mutant("sum", "a wrong sum", "sum.py", "1 + 1", "1 - 1", check, "sums")


@pytest.mark.parametrize(
    ("body", "verdict"),
    [
        ("def test_sum():\n    assert sum.TWO == 2\n", "caught"),
        ("def test_sum():\n    assert sum.TWO is not None\n", "SURVIVED"),
        ("def test_other():\n    assert sum.TWO == 2\n", "broke (4)"),
    ],
)
def test_a_mutant_is_caught_survives_or_breaks_and_leaves_no_trace(
    body: str, verdict: str, tmp_path: Path
) -> None:
    copy = tmp_path / "copy"
    mutant = small(copy, body)
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
    check = BY_NAME["wander"].check
    assert capsys.readouterr().out == f"wander: no wandering current ({check})\n"


def test_a_place_is_found_by_function_and_text_wherever_it_moves(tmp_path: Path) -> None:
    sea = tmp_path / "mjforage" / "sea"
    sea.mkdir(parents=True)
    method = "class Wave:\n    @property\n    def crest(self):\n        return 2\n"
    text = f"{method}\ndef crest():\n    return 2\n"
    (sea / "waves.py").write_text(text, encoding="utf-8")

    def mutant(where: str, old: str = "return 2") -> Mutant:
        return Mutant("crest", "a trough", where, old, "return -2", "leeway", "sea")

    path, spoilt = mutant("Wave.crest").spoilt(tmp_path)
    assert path == sea / "waves.py"
    assert spoilt == text.replace("return 2", "return -2", 1)
    assert mutant("crest").spoilt(tmp_path)[1] == text[:-2] + "-2\n"
    for where, old in (("", "return 2"), ("trough", "return 2"), ("Wave.crest", "return 3")):
        with pytest.raises(ValueError, match=r"mutant crest: [02] times 'return [23]' in"):
            mutant(where, old).spoilt(tmp_path)
