"""A dask cluster for tests of runs."""

from collections.abc import Iterator

import pytest


@pytest.fixture
def scheduler() -> Iterator[str]:
    """Start a cluster of two worker processes, and return its address."""
    pytest.importorskip("distributed")
    from distributed import LocalCluster

    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": "127.0.0.1:0"}
    with LocalCluster(**options) as cluster:  # type: ignore[no-untyped-call]
        yield cluster.scheduler_address
