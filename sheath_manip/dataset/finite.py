"""Whether what is learned from is made of numbers, told by episode, step and feature."""

from collections.abc import Iterable

import numpy as np

from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.mapped import labelled_steps
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.exceptions import StoreError


def require_finite_features(reader: EpisodeReader, names: Iterable[str]) -> None:
    """Raise StoreError where a feature is NaN or infinite in a step that is learned from.

    It names the first such step and feature; one would make a whole fit NaN.
    """
    for name in names:
        header = reader.header(name)
        (spec,) = (spec for spec in layout(header) if spec.path == "features")
        features = reader.array(name, spec)
        broken = ~np.isfinite(features) & labelled_steps(reader, name)[:, None]
        if not broken.any():
            continue
        step, column = np.argwhere(broken)[0].tolist()
        what = repr(header.space.feature_names[column]) if header.space else str(column)
        others = int(broken.any(axis=1).sum()) - 1
        more = f" and another in {others} further steps" if others else ""
        raise StoreError(
            f"{name} of {reader.address}: feature {what} is {features[step, column]} in step "
            f"{step}{more}; wanted numbers to learn from: mark "
            "the stretch as bad in `sheath replay`, or take the episode out with `sheath data drop`"
        )
