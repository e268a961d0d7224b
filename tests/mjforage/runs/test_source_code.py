"""What a source imports, wherever that stands in it, and what code that reaches."""

from collections.abc import Mapping
from pathlib import Path

import pytest

from mjforage.runs.source_code import _imported, decisive_code

SOURCE = """
import a.b
from c import d
if TYPE_CHECKING:
    import never
else:
    import at_run_time
if typing.TYPE_CHECKING:
    from never import at_all
if not TYPE_CHECKING:
    import really
def within():
    for one in range(3):
        with open(one):
            from . import near
try:
    import tried
except ImportError:
    import instead
match 3:
    case 3:
        import matched
class Held:
    async def asked(self):
        import held
"""
FOUND = {
    *("a.b", "c", "c.d", "at_run_time", "really", "package", "package.near"),
    *("tried", "instead", "matched", "held"),
}


def test_imports_are_found_within_every_statement() -> None:
    assert _imported(SOURCE, "package") == FOUND


@pytest.mark.parametrize("call", ["import_module", "importlib.import_module", "__import__"])
def test_modules_imported_by_a_call_are_found_within_every_expression(call: str) -> None:
    text = f"{SOURCE}\nfound = [len({call}('called').name) for _ in (lambda: 3)()]\n{call}(name)"
    assert _imported(text, "package") == FOUND | {"called"}


def test_what_nobody_can_import_imports_nothing() -> None:
    assert _imported("import a\nimport", "package") == set()


def _write(folder: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)


def test_a_relative_import_starts_from_the_folder_of_its_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = {
        "reached_beside.py": "import scipy",
        "reached_home/__init__.py": "",
        "reached_home/common.py": "import reached_beside",
        "reached_home/plans/__init__.py": "from .. import common",
        "reached_home/plans/deep/__init__.py": "from ... import common, plans",
        "reached_home/plans/deep/policy.py": "from ...common import this\nfrom .... import beyond",
    }
    _write(tmp_path, files)
    monkeypatch.syspath_prepend(tmp_path)
    found = decisive_code(["reached_home.plans.deep.policy"])
    assert set(found.files) == set(files)
    assert set(found.versions) == {"scipy"}


def test_a_library_is_a_version_wherever_it_was_installed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = {
        "mine/asks_it.py": "import borrowed, borrowed_helper\nimport asks_it.never",
        "libs/borrowed/__init__.py": "from . import deep",
        "libs/borrowed/deep.py": "import asks_it",
        "libs/borrowed_helper.py": "",
        "libs/borrowed-1.2.dist-info/METADATA": "Name: borrowed\nVersion: 1.2",
        "libs/borrowed-1.2.dist-info/RECORD": "borrowed/__init__.py,sha256=x,9\nborrowed/deep.py,,",
    }
    _write(tmp_path, files)
    for folder in ("mine", "libs"):
        monkeypatch.syspath_prepend(tmp_path / folder)
    found = decisive_code(["asks_it"])
    assert set(found.files) == {"asks_it.py", "borrowed_helper.py"}
    assert found.versions == {"borrowed": "1.2"}
    assert set(decisive_code(["borrowed.deep"]).files) == {
        *("borrowed/__init__.py", "borrowed/deep.py", "asks_it.py", "borrowed_helper.py")
    }
