"""The flags that say what to do with a folder that holds a run already, the same for all."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from mjforage.base.errors import UserError

if TYPE_CHECKING:
    from mjforage.runs.resuming import Resume


@dataclass(frozen=True)
class Resuming:
    """What to do with what --out holds. Without these, the same run goes on, and no other.

    Parameters
    ----------
    fresh
        Begin anew; what --out holds is kept beside it, as NAME.before-TIME.
    accept_code_change
        Go on although code or versions of libraries differ; the folder's file then says so.
    """

    fresh: Annotated[bool, Parameter(negative="")] = False
    accept_code_change: Annotated[bool, Parameter(negative="")] = False

    @property
    def resume(self) -> "Resume":
        """The same for the library."""
        if self.fresh and self.accept_code_change:
            raise UserError("--fresh and --accept-code-change: give one of them")
        if self.fresh:
            return "fresh"
        return "accept-code-change" if self.accept_code_change else "same"


SAME_ONLY = Resuming()
GoingOn = Annotated[Resuming, Parameter(name="*")]
