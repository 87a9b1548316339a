"""Formats that hold all episodes in the same arrays want them alike."""

from collections.abc import Iterable, Iterator

from sheath_manip.dataset.header import Header
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.exceptions import StoreError


def uniform(episodes: Iterable[Recorded]) -> Iterator[Recorded]:
    """The same episodes; raises StoreError at the first of another task, rate or shape."""
    first: Header | None = None
    for recorded in episodes:
        header = recorded.header
        first = first or header
        for what, wanted, found in zip(
            ("task", "control rate", "cameras", "features", "state", "actions"),
            _shape(first),
            _shape(header),
            strict=True,
        ):
            if wanted != found:
                raise StoreError(
                    f"{episode_name(header.info)} has the {what} {found!r}, "
                    f"{episode_name(first.info)} {wanted!r}; this format wants all alike: "
                    "select some, or `sheath data split` the store"
                )
        yield recorded


def _shape(header: Header) -> tuple[object, ...]:
    return (
        header.info.task,
        header.info.control_rate_hz,
        dict(header.cameras),
        header.feature_size,
        header.state_size,
        header.action_size,
    )
