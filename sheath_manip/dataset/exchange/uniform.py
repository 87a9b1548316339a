"""What is written into one file must fit each other, and formats of joined arrays want more."""

from collections.abc import Iterable, Iterator

from sheath_manip.dataset.compatibility import Alike, RecordedSpec
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import StoreError

REMEDY = "a file holds episodes that are alike; select some, or `sheath data split` the store"


def compatible(episodes: Iterable[Recorded]) -> Iterator[Recorded]:
    """Yield the same episodes; raises StoreError at the first that does not fit those before."""
    alike = Alike(REMEDY)
    for recorded in episodes:
        alike.take(episode_name(recorded.header.info), RecordedSpec.of(recorded.header))
        yield recorded


def uniform(episodes: Iterable[Recorded]) -> Iterator[Recorded]:
    """Yield the same episodes as `compatible`.

    Raises StoreError also for simulator states of another size.
    """
    size = None
    for recorded in compatible(episodes):
        header = recorded.header
        size = header.state_size if size is None else size
        if header.state_size != size:
            raise StoreError(
                f"{episode_name(header.info)} has a simulator state of {header.state_size} "
                f"numbers, the first episode of {size}; {REMEDY}"
            )
        yield recorded
