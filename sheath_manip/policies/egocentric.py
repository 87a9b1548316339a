"""The continuous image policy, looking from the tool instead of at the whole image."""

from collections.abc import Mapping
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from sheath_manip.policies.deviation import largest_deviations
from sheath_manip.policies.memoryless import Memoryless
from sheath_manip.policies.spatial_cnn import SpatialPolicy
from sheath_manip.policies.tool_view import ToolView
from sheath_manip.protocols import Arrays
from sheath_manip.types import Observations, Proposal, TaskSpec
from sheath_manip.types.samples import Samples

SETTINGS: Mapping[str, Any] = {"shift_px": 1, "feature_noise": 0.1}
"""of the `SpatialPolicy`, where none are given: the tool stands still in its own view, and what is
left of the features is no habit that could be learned instead of looking"""


class EgocentricPolicy(Memoryless):
    """Regresses in the tool's frame what is to be done there."""

    def __init__(
        self,
        spec: TaskSpec,
        side_px: int = 64,
        px_m: float = 0.0008,
        spatial_settings: Mapping[str, Any] | None = None,
        seed: int = 0,
    ) -> None:
        """Store the hyperparameters; ParameterError for a task without a tool in a plane.

        Args:
            spec: of the task.
            side_px: of the image around the tool.
            px_m: side of one of its pixels.
            spatial_settings: hyperparameters of the `SpatialPolicy` that looks at it.
            seed: of its weights and batches.
        """
        self.spec = spec
        self.side_px = side_px
        self.px_m = px_m
        self.spatial_settings = dict(spatial_settings or {})
        self.seed = seed
        self.view = ToolView(spec, side_px, px_m)
        settings = {**SETTINGS, **self.spatial_settings}
        self.inner = SpatialPolicy(self.view.spec, seed=seed, **settings)
        """what it sees from the tool it leaves to this one"""

    def fit(self, samples: Samples) -> Self:
        """Fit to (n, a) labels; ParameterError for none."""
        self.inner.fit(self.view.samples(samples))
        return self

    def predict(self, observations: Observations) -> Proposal:
        """Regress actions in the tool's frame; return the task's, cut to their bounds.

        Latents: those of the policy that sees, and what it was shown, as `tool images` (a mapping
        by camera) and `tool features`.
        """
        features = observations.features
        camera = self.view.frame.camera
        shown = Observations(
            {camera: self.view.images(observations.images[camera], features)},
            self.view.features(features),
        )
        seen = self.inner.predict(shown)
        low, high = self.spec.action.minimum, self.spec.action.maximum
        actions = np.clip(self.view.actions_in_world(seen.now, features), low, high)
        looked_at = {"tool images": shown.images, "tool features": shown.features}
        return Proposal(actions, {**seen.latents, **looked_at})

    def in_own_frame(self, actions: NDArray, features: NDArray) -> NDArray[np.float32]:
        """(n, a) `actions` as seen from the tool."""
        return self.view.actions(actions, features)

    def surrogate_losses(self, proposal: Proposal, labels: NDArray) -> NDArray[np.float32]:
        """(n,) the largest deviation of any dimension from its label, as a share of its range."""
        return largest_deviations(self.spec.action, proposal.now, labels)

    def arrays(self) -> Arrays:
        """Return the arrays of the policy that sees."""
        return self.inner.arrays()

    def load(self, arrays: Arrays) -> Self:
        """Take over `arrays()` of a policy of the same shape; ParameterError for another's."""
        self.inner.load(arrays)
        return self
