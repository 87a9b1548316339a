"""An episode as LeRobot's features: what is written there, by its names there."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.exchange.actions import REQUESTED, chosen, requested
from sheath_manip.dataset.exchange.lerobot import feature_name
from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.layout import LIMITED, SIGNALS, layout
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.types import Outcome

_ACTIONS = ("action", REQUESTED, "proposed", "labelled", "executed")
_AXES = ["height", "width", "channels"]


def columns_of(recorded: Recorded, action: ActionChoice) -> dict[str, NDArray]:
    """Return (T, ...) by feature; LeRobot has no scalars and no empty vectors."""
    header, arrays = recorded.header, recorded.arrays
    last = np.arange(header.length) == header.length - 1
    named = {
        feature_name(spec.path): arrays[spec.path]
        for spec in layout(header)
        if not spec.path.startswith("final/") and spec.path not in (LIMITED, SIGNALS)
    }
    # Its frames are all alike, but an episode has columns for its own limits and signals alone.
    named[LIMITED] = _largest(arrays[LIMITED]) if header.limits else np.full(len(last), np.nan)
    named["action"] = chosen(recorded, action)
    named[REQUESTED] = requested(recorded)
    named["next.terminated"] = last & header.terminated
    named["next.truncated"] = last & header.truncated
    named["next.done"] = last
    named["next.success"] = last & (header.outcome is Outcome.SUCCESS)
    return {
        name: values if values.ndim > 1 else values[:, None]
        for name, values in named.items()
        if values.size
    }


def features(recorded: Recorded, action: ActionChoice) -> dict[str, Any]:
    """Return what a data set says of its columns, the names of their entries where known."""
    space = recorded.header.space
    names = {}
    if space is not None:
        names = {name: list(space.action_names) for name in _ACTIONS}
        names["observation.state"] = list(space.feature_names)
    return {
        name: {"dtype": "image", "shape": values.shape[1:], "names": _AXES}
        if values.ndim == 4
        else {"dtype": values.dtype.name, "shape": values.shape[1:], "names": names.get(name)}
        for name, values in columns_of(recorded, action).items()
    }


def _largest(limited: NDArray) -> NDArray[np.float64]:
    """(T,) of (T, l) with NaN where a limit did not act."""
    return np.where(np.isnan(limited).all(axis=1), np.nan, np.nan_to_num(limited).max(axis=1))
