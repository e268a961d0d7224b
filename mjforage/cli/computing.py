"""The flags that say who computes, the same for every command that runs episodes."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

if TYPE_CHECKING:
    from mjforage.runs.workers import Workers


@dataclass(frozen=True)
class Computing:
    """Who computes.

    Parameters
    ----------
    jobs
        Worker processes.
    scheduler
        Address of a dask scheduler, for example tcp://host:8786, whose workers compute instead.
    local_cluster
        Start a dask cluster of this many worker processes here, and let it compute.
    """

    jobs: int = 1
    scheduler: str | None = None
    local_cluster: int = 0

    @property
    def workers(self) -> "Workers":
        """The same for the library."""
        from mjforage.base.errors import UserError
        from mjforage.runs.workers import Workers

        if self.scheduler == "":  # of an unset variable of a shell, perhaps: not to compute here
            raise UserError("--scheduler: the address is empty; give one such as tcp://host:8786")
        return Workers(self.jobs, self.scheduler or "", self.local_cluster)


THIS_PROCESS = Computing()
By = Annotated[Computing, Parameter(name="*")]
