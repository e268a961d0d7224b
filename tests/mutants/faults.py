"""Single faults of the physics as data: what is changed, and which check has to fail."""

import tomllib
from dataclasses import dataclass, fields
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]  # of the repository
PHYSICS = "mjforage/physics"


@dataclass(frozen=True)
class Mutant:
    """One fault.

    Attributes
    ----------
    name : on the command line
    fault : in words
    file : in `mjforage/physics`, or in the repository if it is there
    old, new : text that occurs once in the file, and what takes its place
    check : of `mjforage validate`, or a test, `tests/.../test_file.py::test_name`
    """

    name: str
    fault: str
    file: str
    old: str
    new: str
    check: str

    def path(self, root: Path = ROOT) -> Path:
        """The file in a copy of the repository."""
        return root / (self.file if (ROOT / self.file).is_file() else f"{PHYSICS}/{self.file}")

    @property
    def is_test(self) -> bool:
        """Whether the check is a test, not one of `mjforage validate`."""
        return "::" in self.check


def mutants() -> list[Mutant]:
    """All mutants, in the order of their files.

    Raises
    ------
    ValueError
        If an entry has other keys than `Mutant`, or a name stands twice.
    """
    found = []
    wanted = {field.name for field in fields(Mutant)}
    for file in sorted(HERE.glob("*.toml")):
        for entry in tomllib.loads(file.read_text(encoding="utf-8"))["mutant"]:
            if entry.keys() != wanted:
                raise ValueError(f"{file.name}: {entry.get('name')} has keys {sorted(entry)}")
            found.append(Mutant(**entry))
    names = [mutant.name for mutant in found]
    if twice := {name for name in names if names.count(name) > 1}:
        raise ValueError(f"mutants named twice: {', '.join(sorted(twice))}")
    return found
