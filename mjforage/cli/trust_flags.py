"""The flag by which a user lets files name code, the same for every command that reads them."""

from dataclasses import dataclass
from typing import Annotated

from cyclopts import Parameter


@dataclass(frozen=True)
class Trusting:
    """Which code files may name, beside what ships and what installed packages bring.

    Made of the command line alone: to make one is the user's word.

    Parameters
    ----------
    trust
        MODULE:CLASS of your own that a run folder, a study or weights may name, beside what this
        command names; any other code is refused. Repeatable.
    """

    trust: Annotated[tuple[str, ...], Parameter(negative="")] = ()

    def __post_init__(self) -> None:
        from mjforage.base.registry import trust

        trust(*self.trust)


NOBODY = Trusting()
Trusted = Annotated[Trusting, Parameter(name="*")]


def own_word(*policies: str | None) -> None:
    """Take the policies of a command line as the user's word for their code."""
    from mjforage.base.registry import trust

    trust(*(name for one in policies if one and ":" in (name := one.partition("(")[0].strip())))
