"""What an episode must be before any of it is written."""

from collections.abc import Iterable

from sheath_manip.dataset.attributes import require_storable
from sheath_manip.dataset.group import episode_files
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.dataset.steps import not_finite, require_layout, require_sound
from sheath_manip.dataset.zarr_files import File
from sheath_manip.exceptions import StoreError


def storable_files(recorded: Recorded) -> Iterable[File]:
    """Return the files of an episode, made as they are asked for; StoreError where it is none."""
    header, arrays = recorded.header, recorded.arrays
    require_storable(header)
    require_layout(header, arrays)
    for array in not_finite(arrays):
        raise StoreError(
            f"{episode_name(header.info)}: an action in {array!r} is not finite; "
            "check actions with ActionSpec.validated"
        )
    require_sound(header, arrays)
    return episode_files(recorded)
