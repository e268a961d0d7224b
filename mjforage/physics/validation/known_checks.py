"""The checks by name; a new one is a decorated function in a file that `all_checks` imports."""

from collections.abc import Callable
from dataclasses import dataclass

from mjforage.base.errors import UserError
from mjforage.base.references import nearest
from mjforage.physics.validation.finding import Finding, Measure, Panel

Parts = tuple[tuple[Measure, ...], tuple[Panel, ...]]


@dataclass(frozen=True)
class Check:
    """A check that can be run."""

    name: str
    number: str
    title: str
    shows: str
    parts: Callable[[], Parts]

    def __call__(self) -> Finding:
        """Run it."""
        return self.finding(self.parts())

    def finding(self, parts: Parts) -> Finding:
        """Parts with the words of this check."""
        return Finding(self.name, self.number, self.title, self.shows, *parts)


_CHECKS: dict[str, Check] = {}


def check(name: str, number: str, title: str) -> Callable[[Callable[[], Parts]], Check]:
    """Register a function as a check; its docstring says what it shows.

    Parameters
    ----------
    name : on the command line
    number : where it stands in the report's list; several may share one, as 14a and 14b
    title : in a few words
    """

    def register(function: Callable[[], Parts]) -> Check:
        words = " ".join((function.__doc__ or "").split())
        made = Check(name, number, title, words, function)
        _CHECKS[name] = made
        return made

    return register


def check_names() -> list[str]:
    """Names of all checks in the order of the report."""
    return sorted(_CHECKS, key=lambda name: _order(_CHECKS[name].number))


def find_check(name: str) -> Check:
    """A check by name.

    Raises
    ------
    UserError
        If there is none of that name.
    """
    if name not in _CHECKS:
        raise UserError(f"--check {name}: unknown; {nearest(name, check_names())}")
    return _CHECKS[name]


def _order(number: str) -> tuple[int, str]:
    digits = "".join(c for c in number if c.isdigit())
    return int(digits), number[len(digits) :]
