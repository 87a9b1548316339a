"""A cluster of Ray on this machine: each file of tests makes a fixture of the scope it needs."""

from collections.abc import Iterator
from typing import Any

import pytest


def two_nodes() -> Iterator[Any]:
    """Two machines, as far as Ray can tell, of two cores each."""
    patience = {"RAY_USAGE_STATS_ENABLED": "0", "RAY_agent_register_timeout_ms": "200000"}
    with pytest.MonkeyPatch.context() as patch:
        for name, value in patience.items():
            patch.setenv(name, value)
        from ray.cluster_utils import Cluster  # pyright: ignore[reportMissingImports] - an extra

        options = {"num_cpus": 2, "object_store_memory": 100 * 2**20}
        cluster = Cluster(
            initialize_head=True, head_node_args=options | {"include_dashboard": False}
        )
        cluster.add_node(**options)
        try:
            yield cluster
        finally:
            cluster.shutdown()
