"""A cluster of Ray on this machine: each file of tests makes a fixture of the scope it needs."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest


def two_nodes() -> Iterator[Any]:
    """Two machines, as far as Ray can tell, of two cores each."""
    patience = {"RAY_USAGE_STATS_ENABLED": "0", "RAY_agent_register_timeout_ms": "200000"}
    with pytest.MonkeyPatch.context() as patch:
        for name, value in patience.items():
            patch.setenv(name, value)
        from ray.cluster_utils import Cluster  # pyright: ignore[reportMissingImports] - an extra

        cluster = _begun(Cluster)
        try:
            yield cluster
        finally:
            cluster.shutdown()


def _begun(make: Callable[..., Any], tries: int = 3) -> Any:
    options = {"num_cpus": 2, "object_store_memory": 100 * 2**20}
    for left in reversed(range(tries)):
        head = options | {"include_dashboard": False}
        cluster = make(initialize_head=False)
        try:
            cluster.add_node(**head)
            cluster.add_node(**options)
            return cluster
        except Exception:
            # Ray gives a node 30 s to start, which a busy machine may take.
            cluster.shutdown()
            if not left:
                raise
    raise AssertionError
