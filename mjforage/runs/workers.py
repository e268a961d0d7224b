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
    local_cluster : worker processes of a dask cluster started on this machine instead
    """

    jobs: int = 1
    scheduler: str = ""
    local_cluster: int = 0

    def __post_init__(self) -> None:
        for flag, count, least in (
            ("jobs", self.jobs, 1),
            ("local-cluster", self.local_cluster, 0),
        ):
            if count < least:
                raise UserError(f"--{flag} {count}: give at least 1 worker")
        if (self.jobs > 1) + bool(self.scheduler) + bool(self.local_cluster) > 1:
            raise UserError("--jobs, --scheduler and --local-cluster: give one of them")
        if self.scheduler:
            cluster.check_address(self.scheduler)

    @property
    def remote(self) -> bool:
        """True if a dask cluster computes."""
        return bool(self.scheduler or self.local_cluster)

    @property
    def elsewhere(self) -> bool:
        """True if other processes compute."""
        return self.remote or self.jobs > 1

    def invocation(self, policies: Iterable[str], metrics: Iterable[str] = ()) -> Invocation:
        """Check that they can compute these policies and metrics, before anything is written.

        Raises
        ------
        UserError
            If dask is missing, the scheduler cannot be reached or has no workers, or they lack the
            weights or cannot import a policy or metric.
        """
        started, count = datetime.now(UTC).isoformat(), self.local_cluster or self.jobs
        how = "local dask cluster" if self.local_cluster else "processes"
        if self.elsewhere:
            policy_import_specs(policies)
            import_specs_of(chosen_metrics(metrics))
        if self.remote:
            cluster.check_dask()
        if self.scheduler:
            _check_weights(policies)
            how = f"dask at {self.scheduler}"
            with cluster.connected(self.scheduler, 0) as client:
                count = cluster.cores(client)
        return Invocation(started, how, count)


def _check_weights(policies: Iterable[str]) -> None:
    for name in policies:
        if own_weights(name) is not None:
            raise UserError(
                f"policy {name}: weights of this folder are not where a cluster's workers are; "
                "compute it with --jobs"
            )


def policy_import_specs(policies: Iterable[str]) -> tuple[tuple[str, ImportSpec], ...]:
    """Import paths, for other processes, of the policies that are not ours."""
    found = ((policy, policy_import_spec(policy)) for policy in policies)
    return tuple((policy, place) for policy, place in found if place is not None)
