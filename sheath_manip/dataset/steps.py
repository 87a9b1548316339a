"""How the steps of an episode become arrays, and what arrays must hold."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.faults import REMEDY, Fault, FaultError, FaultKind
from sheath_manip.dataset.header import Header, columns_of, header_of
from sheath_manip.dataset.layout import LIMITED, SIGNALS, Arrays, layout
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.recorded import Frames, Recorded
from sheath_manip.dataset.space import Space
from sheath_manip.exceptions import StoreError
from sheath_manip.types import Episode

COLUMNS = (
    "features",
    "time_s",
    "state",
    "proposed",
    "has_proposed",
    "labelled",
    "has_labelled",
    "executed",
    "actor",
    "reason",
    "intervention",
    "query",
    "score",
    "threshold",
    "reward",
)
"""of `Episode.columns`, as they are stored"""


def recorded_of(episode: Episode, space: Space | None = None) -> Recorded:
    """The episode by column, whose features and actions mean what `space` says.

    Raises StoreError as `header_of` and `arrays_of` do.
    """
    header = header_of(episode, space)
    return Recorded(header, arrays_of(episode, header))


def arrays_of(episode: Episode, header: Header) -> Mapping[str, Any]:
    """The arrays of `layout(header)`, the images of the steps as `Frames`.

    Raises StoreError where the steps of `episode` disagree.
    """
    name = episode_name(episode.info)
    steps = episode.steps
    for step in steps:
        if step.observation.images.keys() != header.cameras.keys():
            raise StoreError(
                f"{name}: wanted the cameras {list(header.cameras)} in every step, "
                f"one has {list(step.observation.images)}"
            )
    final = episode.final_observation
    try:
        columns = columns_of(episode)
        return {
            **{
                f"images/{camera}": Frames([step.observation.images[camera] for step in steps])
                for camera in header.cameras
            },
            **{column: getattr(columns, column) for column in COLUMNS},
            **({LIMITED: _limited(episode, header)} if header.limits else {}),
            **(
                {SIGNALS: np.stack([columns.signals[name] for name in header.signals], axis=1)}
                if header.signals
                else {}
            ),
            **{
                f"final/images/{camera}": np.asarray(final.images[camera])
                for camera in header.cameras
            },
            "final/features": np.asarray(final.features),
            "final/time_s": np.array(final.time_s, np.float64),
            "final/state": np.asarray(episode.final_state),
        }
    except ValueError as error:
        raise StoreError(f"{name}: its steps have arrays of different shapes ({error})") from error


def require_layout(header: Header, arrays: Mapping[str, Any]) -> None:
    """Raise StoreError where an array is missing or not of the shape and type of `layout`."""
    for spec in layout(header):
        array = arrays.get(spec.path)
        found = "missing" if array is None else f"{array.dtype} {array.shape}"
        # A silent conversion would make the replay differ from what was recorded.
        if array is None or array.shape != spec.shape or array.dtype != spec.dtype:
            raise StoreError(
                f"{episode_name(header.info)}: {spec.path} is {found}; "
                f"wanted {spec.dtype} {spec.shape}"
            )


def require_sound(header: Header, arrays: Arrays) -> None:
    """Raise FaultError at the first of `content_faults`."""
    for fault in content_faults(header, arrays):
        raise FaultError(fault.name, fault.kind, fault.text)


def content_faults(header: Header, arrays: Arrays) -> list[Fault]:
    """Return what is wrong with values that decode: unknown codes, other counts, bad actions."""
    name = episode_name(header.info)
    for array, meanings in (("actor", header.actors), ("reason", header.reasons)):
        highest = arrays[array].max()
        if highest >= len(meanings):
            text = f"{array} holds the code {highest}, its header knows {len(meanings)}; {REMEDY}"
            return [Fault(name, FaultKind.MISMATCH, text)]
    counts = {
        "steps by the expert": (header.expert_steps, by_expert(header, arrays).sum()),
        "queries": (header.queries, arrays["query"].sum()),
    }
    return [
        *(
            Fault(
                name,
                FaultKind.MISMATCH,
                f"its header tells of {told} {what}, its arrays hold {held}; {REMEDY}",
            )
            for what, (told, held) in counts.items()
            if told != held
        ),
        *(
            Fault(name, FaultKind.NOT_FINITE, f"an action in {array!r} is not finite; {REMEDY}")
            for array in not_finite(arrays)
        ),
    ]


def content_remarks(header: Header, arrays: Arrays) -> list[Fault]:
    """Return what is worth to be known of values as they were recorded: features that are none."""
    rows, columns = np.nonzero(~np.isfinite(arrays["features"]))
    if not len(rows):
        return []
    names = None if header.space is None else header.space.feature_names
    which = f"feature {int(columns[0]) if names is None else names[columns[0]]!r}"
    more = f", and {len(rows) - 1} more values are not finite" * (len(rows) > 1)
    value = arrays["features"][rows[0], columns[0]]
    text = f"{which} is {value} in step {rows[0]}{more}; nothing can be learned from that"
    return [Fault(episode_name(header.info), FaultKind.REMARK, text)]


def by_expert(header: Header, arrays: Arrays) -> NDArray[np.bool_]:
    """Return (T,) whether expert, operator or fallback drove in the policy's place."""
    return np.array([actor.in_place_of_policy for actor in header.actors])[arrays["actor"]]


def not_finite(arrays: Arrays) -> list[str]:
    """Return which of the actions that were executed or are trained on hold NaN or infinity.

    What the policy merely proposed may: that is evidence about the policy.
    """
    labelled = arrays["labelled"][arrays["has_labelled"]]
    actions = {"executed": arrays["executed"], "labelled": labelled}
    return [name for name, action in actions.items() if not np.isfinite(action).all()]


def _limited(episode: Episode, header: Header) -> NDArray[np.float64]:
    """(T, l) with NaN where a limit did not act."""
    by = np.full((len(episode), len(header.limits)), np.nan)
    for row, step in zip(by, episode.steps, strict=True):
        for each in step.limited:
            row[header.limits.index(each.limit)] = each.by
    return by
