"""Tables of names: ours, those of installed packages, and `module:Name` of the present folder."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from mjforage.base.errors import UserError
from mjforage.base.extras import extra_with
from mjforage.base.registry import ImportSpec, Registry

METADATA = "Metadata-Version: 2.1\nName: reef-tools\nVersion: 1.2\n"
SOURCE = '''class Reef:
    """Around the reef."""

    def __init__(self, depth: float = 2.0) -> None:
        self.depth = depth
'''


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The present folder; modules from it are forgotten afterwards."""
    monkeypatch.chdir(tmp_path)
    path, modules = list(sys.path), set(sys.modules)
    yield tmp_path
    sys.path[:] = path
    for name in set(sys.modules) - modules:
        del sys.modules[name]


@pytest.fixture
def installed(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A package with an entry point, as pip leaves it."""
    (folder / "site" / "reef_tools-1.2.dist-info").mkdir(parents=True)
    facts = folder / "site" / "reef_tools-1.2.dist-info"
    (facts / "METADATA").write_text(METADATA)
    (facts / "entry_points.txt").write_text("[tests.boats]\nreef = reef_tools:Reef\n")
    (folder / "site" / "reef_tools.py").write_text(SOURCE)
    monkeypatch.syspath_prepend(folder / "site")
    return folder


def boats() -> "Registry[type]":
    return Registry("boat", "tests.boats")


def test_an_installed_package_brings_names_and_says_where_from(installed: Path) -> None:
    table = boats()
    assert table.names() == ["reef"] and table.origin("reef") == "reef-tools 1.2"
    assert table.find("reef")().depth == 2.0
    assert str(table.bound("reef(depth=3)")[0]) == "reef(depth=3)"


def test_a_module_of_the_present_folder_is_found_and_hides_nothing(folder: Path) -> None:
    (folder / "reef.py").write_text(SOURCE)
    (folder / "json.py").write_text("raise SystemExit")
    table = boats()
    assert table.find("reef:Reef")().depth == 2.0 and table.origin("reef:Reef") == "reef"
    assert sys.path.index(str(folder)) == len(sys.path) - 1


def test_another_process_finds_it_by_its_place(folder: Path) -> None:
    package = folder / "yard" / "boats"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text("")
    (package / "reef.py").write_text(SOURCE)
    sys.path.append(str(folder / "yard"))
    places = boats().import_specs(["boats.reef:Reef"])
    assert places == {"boats.reef:Reef": ImportSpec("boats.reef:Reef", str(folder / "yard"))}
    sys.path.remove(str(folder / "yard"))
    for name in ("boats.reef", "boats"):
        del sys.modules[name]
    other = boats()
    other.add("mine", ImportSpec("boats.reef:Reef", str(folder / "yard")))
    assert other.find("mine").__doc__ == "Around the reef."
    before = other.names()
    other.add("boats.reef:Reef", ImportSpec("boats.reef:Reef", str(folder / "yard")))
    assert other.has("boats.reef:Reef") and other.names() == before


def test_a_module_of_an_extra_is_installed_with_it(installed: Path) -> None:
    assert extra_with("stable_baselines3.common") == "libraries"
    assert not extra_with("no_such_thing") and not extra_with("numpy")
    (installed / "needy.py").write_text("raise ModuleNotFoundError(name='stable_baselines3')")
    with pytest.raises(UserError, match=r"install it with pip install 'mjforage\[libraries\]'"):
        boats().find("needy:X")


def test_what_is_of_a_function_or_script_is_refused_with_the_remedy() -> None:
    class Local:
        pass

    table = boats()
    table.register("local")(Local)
    with pytest.raises(UserError, match=r"boat local: .*Local is defined in the script itself or"):
        table.import_specs(["local"])


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("reff", "boat reff: unknown; did you mean reef"),
        ("nowhere:Reef", "boat nowhere:Reef: no module nowhere is installed or in "),
        ("reef_tools:Ref", "reef_tools has no Ref; did you mean Reef"),
        ("needs:X", "module needs needs no_such_thing; install it"),
        ("broken:X", r"broken.py, line 1: "),
        ("wrong:X", "module wrong cannot be imported .NameError: name 'nothing'"),
        ("ending:X", "module ending ends the process"),
        ("..:X", "expected package.module:Name"),
        ("ending:", "expected package.module:Name"),
        ("things:math", "is a module; give a class"),
        ("things:HALF", "is a partial; give a class"),
    ],
)
def test_what_cannot_be_had_is_one_line(installed: Path, name: str, words: str) -> None:
    (installed / "needs.py").write_text("import no_such_thing")
    (installed / "broken.py").write_text("def (:")
    (installed / "wrong.py").write_text("nothing")
    (installed / "ending.py").write_text("import sys; sys.exit(3)")
    (installed / "things.py").write_text("import functools, math; HALF = functools.partial(int, 5)")
    with pytest.raises(UserError, match=words) as caught:
        boats().find(name)
    assert "\n" not in str(caught.value)
