"""Workers: processes of this machine or a dask cluster, checked before anything is written."""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime

from mjforage.base.errors import UserError
from mjforage.base.registry import ImportSpec
from mjforage.graph_planner.policies.registry import own_weights, policy_import_spec
from mjforage.mission.scoring import chosen_metrics, import_specs_of
from mjforage.runs import cluster
from mjforage.runs.costs import Invocation


@dataclass(frozen=True)
class Workers:
    """Workers that compute.

    Attributes
    ----------
    jobs : processes of this machine; 1 stays in this process
    scheduler : address of a dask scheduler, whose workers compute instead
    """

    jobs: int = 1
    scheduler: str = ""

    def __post_init__(self) -> None:
        if self.jobs < 1:
            raise UserError(f"jobs {self.jobs}: give at least 1 worker")
        if self.jobs > 1 and self.scheduler:
            raise UserError("jobs and scheduler: give one of them")
        if self.scheduler:
            cluster.check_address(self.scheduler)

    @property
    def remote(self) -> bool:
        """True if a dask cluster computes."""
        return bool(self.scheduler)

    @property
    def elsewhere(self) -> bool:
        """True if other processes compute."""
        return self.remote or self.jobs > 1

    def invocation(self, policies: Iterable[str], metrics: Iterable[str] = ()) -> Invocation:
        """Check that they can compute these policies and metrics, before anything is written.

        Raises `UserError` if dask is missing, the scheduler cannot be reached or has no workers, or
        they lack the weights or cannot import a policy or metric.
        """
        started, count, how = datetime.now(UTC).isoformat(), self.jobs, "processes"
        if self.elsewhere:
            policy_import_specs(policies)
            import_specs_of(chosen_metrics(metrics))
        if self.remote:
            cluster.check_dask()
            _check_weights(policies)
            how = f"dask at {self.scheduler}"
            with cluster.connected(self.scheduler) as client:
                count = cluster.cores(client)
        return Invocation(started, how, count)


def _check_weights(policies: Iterable[str]) -> None:
    for name in policies:
        if own_weights(name) is not None:
            raise UserError(
                f"policy {name}: weights of this folder are not where a cluster's workers are; "
                "compute it on this machine"
            )


def policy_import_specs(policies: Iterable[str]) -> tuple[tuple[str, ImportSpec], ...]:
    """Import paths, for other processes, of the policies that are not ours."""
    found = ((policy, policy_import_spec(policy)) for policy in policies)
    return tuple((policy, place) for policy, place in found if place is not None)
