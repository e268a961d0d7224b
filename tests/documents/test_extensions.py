"""Extensions of the site: short types of arrays, comments of fields."""

import importlib.util
from collections.abc import Callable
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from tests.packaging.contents import REPOSITORY


def extension(name: str) -> ModuleType:
    pytest.importorskip("sphinx")
    file = REPOSITORY / "docs" / "_site" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(name, file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize(
    ("long", "short"),
    [
        ("(a: ~numpy.ndarray[tuple[~typing.Any, ...], ~numpy.dtype[~numpy.int16]])", "int16"),
        ("(a: ndarray[tuple[Any, ...], dtype[int16]])", "int16"),
    ],
)
def test_an_array_is_named_by_its_numbers(long: str, short: str) -> None:
    assert extension("docstrings").shorter(long) == f"(a: ndarray[{short}])"


def test_what_may_become_an_array_has_its_name() -> None:
    long = (
        "(x: _Buffer | _SupportsArray[dtype[Any]] | _NestedSequence[_SupportsArray[dtype[Any]]] |"
        " complex | bytes | str | _NestedSequence[complex | bytes | str], seed: int,"
        " how: ~collections.abc.Callable = <function mean>, more: dict = <factory>)"
    )
    short = "(x: ArrayLike, seed: int, how: Callable = mean, more: dict = ...)"
    assert extension("docstrings").shorter(long) == short
    assert extension("docstrings").shorter(None) is None


def test_a_field_of_a_named_tuple_is_told_by_its_comment() -> None:
    from mjforage.mission.task import Observation

    fields = extension("docstrings").fields_of(Observation)
    assert set(fields) == set(Observation._fields) and all(fields.values())
    assert fields["last_seen"] == "(row, node) step, NEVER if not yet seen"


def test_a_description_beside_a_name_is_no_type() -> None:
    lines = [
        "Thing.",
        "",
        "Parameters",
        "----------",
        "path : Path",
        "    Its file.",
        "size, n : two",
    ]
    lines += ["    whole numbers", "", "Raises", "------", "UserError : never"]
    extension("docstrings").write_parameters(None, "", "", None, None, lines)
    assert lines[4:9] == ["path : Path", "    Its file.", "size, n", "    two", "    whole numbers"]
    assert lines[-1] == "UserError : never"


def test_what_notebooks_leave_in_their_folder_is_an_error(tmp_path: Path) -> None:
    folder, connected = tmp_path / "notebooks", dict[str, Callable[..., Any]]()
    folder.mkdir()
    app = SimpleNamespace(srcdir=tmp_path, connect=connected.__setitem__)
    extension("clean_notebooks").setup(app)
    connected["env-updated"](app, None)
    (folder / "run.csv").touch()
    with pytest.raises(Exception, match=r"notebooks leave run\.csv in"):
        connected["env-updated"](app, None)
