"""The list of mutants cannot rot: every text is in its file once, every check exists."""

import ast

import pytest

from tests.mjforage.physics.validation.measures import CHECKS
from tests.mjforage.physics.validation.table import MODULES
from tests.mutants.__main__ import page
from tests.mutants.faults import ROOT, Mutant, mutants

ALL = mutants()


@pytest.mark.parametrize("mutant", ALL, ids=lambda mutant: mutant.name)
def test_the_text_is_in_its_file_once(mutant: Mutant) -> None:
    path, spoilt = mutant.spoilt()
    assert spoilt != path.read_text(encoding="utf-8")
    if path.suffix == ".py":
        ast.parse(spoilt)


@pytest.mark.parametrize("check", sorted({mutant.check for mutant in ALL}))
def test_the_check_exists(check: str) -> None:
    file, _, name = check.partition("::")
    tree = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    tests = [node.name for node in tree.body if isinstance(node, ast.FunctionDef)]
    assert name.partition("[")[0] in tests


def test_each_check_of_the_physics_notices_a_fault() -> None:
    file = "tests/mjforage/physics/validation/test_checks.py"
    checks = {f"{file}::test_check[{name}]" for name in CHECKS}
    assert MODULES and checks == {mutant.check for mutant in ALL if mutant.check.startswith(file)}


def test_the_page_has_them_all_once() -> None:
    assert len({mutant.name for mutant in ALL}) == len(ALL)
    assert (ROOT / "docs" / "mutants.md").read_text("utf-8") == page(ALL)
