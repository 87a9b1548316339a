"""How many threads the numerics take."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

from threadpoolctl import threadpool_limits

THREADS = 1
"""of torch and BLAS each, in an experiment: another number adds up in another order, so that only
runs with the same number give the same result to the bit"""


def one_thread_by_default() -> None:
    """Let numpy and torch take one thread unless OMP_NUM_THREADS is set; call it before importing
    them.

    On two cores, two threads in each of two processes cost many times what they give.
    """
    # An empty one says as little as none, and would be one thread a core.
    os.environ["OMP_NUM_THREADS"] = os.environ.get("OMP_NUM_THREADS") or str(THREADS)


@contextmanager
def single_threaded() -> Iterator[None]:
    """Allow torch and BLAS one thread while rollouts run.

    Two threads beside another busy process made a 0.2 ms forward take 33 ms.
    """
    # Only now: when this module is imported, the default above need not be set yet.
    import torch

    before = torch.get_num_threads()
    torch.set_num_threads(THREADS)
    try:
        with threadpool_limits(THREADS):
            yield
    finally:
        torch.set_num_threads(before)
