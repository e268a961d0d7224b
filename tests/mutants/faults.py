"""Single faults as data: what is changed, and which check has to fail."""

import ast
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from glob import glob
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]  # of the repository
PACKAGE = "mjforage"
"""Folder of Python files in which a fault's place is looked for; links are followed."""


@dataclass(frozen=True)
class Mutant:
    """One fault, named by the content of its place, which may move to another file.

    Attributes
    ----------
    name : on the command line
    fault : in words
    where : qualified name of a function or class, such as `Mission.adopt`; "" for text of a file
        outside of functions; the path of a file that is no Python
    old, new : text that occurs once there and in no other place of that name, and what takes its
        place
    check : a test, `tests/.../test_file.py::test_name`
    topic : name of the TOML file that holds it
    """

    name: str
    fault: str
    where: str
    old: str
    new: str
    check: str
    topic: str

    def spoilt(self, root: Path = ROOT) -> tuple[Path, str]:
        """The file in a copy of the repository, and its text with the fault.

        Raises
        ------
        ValueError
            If the text is in no such place, or in several.
        """
        if (data := root / self.where).is_file():
            found = [(data, 0, _text(data))]
        else:
            found = list(self._places(root))
        places = [each for each in found if self.old in each[2]]
        times = sum(text.count(self.old) for _, _, text in places)
        if times != 1:
            raise ValueError(f"mutant {self.name}: {times} times {self.old!r} in {self.where!r}")
        ((path, begin, text),) = places
        whole = _text(path)
        return path, whole[:begin] + text.replace(self.old, self.new) + whole[begin + len(text) :]

    def _places(self, root: Path) -> Iterator[tuple[Path, int, str]]:
        """File, offset and text of every place of the name."""
        for path in _sources(root):
            whole = _text(path)
            if self.old not in whole:
                continue
            if not self.where:
                yield path, 0, whole
                continue
            starts = [0, *(m for m, c in enumerate(whole, 1) if c == "\n")]
            for name, node in _named(ast.parse(whole)):
                if name == self.where:
                    first = min([node.lineno, *(each.lineno for each in node.decorator_list)])
                    begin = starts[first - 1]
                    yield path, begin, whole[begin : (*starts, len(whole))[node.end_lineno or -1]]


Named = ast.FunctionDef | ast.ClassDef


def _named(tree: ast.AST, outer: str = "") -> Iterator[tuple[str, Named]]:
    """Functions and classes by qualified names."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, Named):
            yield f"{outer}{node.name}", node
            yield from _named(node, f"{outer}{node.name}.")
        else:
            yield from _named(node, outer)


@cache
def _text(path: Path) -> str:
    """Text of a file as it is without a fault."""
    return path.read_text("utf-8")


@cache
def _sources(root: Path) -> tuple[Path, ...]:
    found = glob(f"{root}/{PACKAGE}/**/*.py", recursive=True)  # noqa: PTH207 - follows links
    return tuple(map(Path, sorted(found)))


def mutants() -> list[Mutant]:
    """All mutants, in the order of their files."""
    return [
        Mutant(**entry, topic=file.stem)
        for file in sorted(HERE.glob("*.toml"))
        for entry in tomllib.loads(file.read_text(encoding="utf-8"))["mutant"]
    ]
