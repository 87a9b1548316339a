"""Vectors made of what the policy's convolution layers see.

How well each tells displaced expert states of the driving task from new ones, as AUROC: 3.5 m and
5 m aside, turned by 45°, a car put in front; then the policy's costly mistakes from its other
states. Measured on tuning scenes with 10 laps of demonstrations, one-class SVM, mean of two runs,
the policy plain unless painting (see `reconstruction.py`):

    embedding                          3.5 m    5 m    45°  front  mistakes
    penultimate                         .73    .74    .71    .55    .68
    pooled, standardised                .95    .99    .97    .58    .74
    foveal, whitened                    .95    .98    .85   1.00    .92
    foveal, contrast-whitened           .99   1.00    .93   1.00    .93
      and the policy painting           .99   1.00    .92   1.00    .94
    two-scale, contrast-whitened        .98   1.00    .99    .96    .88
      and the policy painting           .98   1.00    .99    .97    .89
    pixels, whitened                    .99   1.00   1.00    .77    .84

Two other training runs on more scenes, the policy painting:

    two-scale, contrast-whitened        .98   1.00    .99    .97    .87
    pixels, whitened                    .98   1.00    .99    .79    .86
    both side by side, pixels twice     .98   1.00    .99    .96    .88
"""

from typing import final

import numpy as np
import torch
from numpy.typing import NDArray
from torch.nn import functional

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.cnn import ConvPolicy
from sheath_manip.policies.embeddings import Images, ScaledEmbedding
from sheath_manip.protocols import Policy
from sheath_manip.seeding import seed_for

# The share of the last layer's sides that lies around the middle of the image.
MIDDLE = 0.5


class _ConvolutionalEmbedding(ScaledEmbedding):
    policy: ConvPolicy

    def attach(self, policy: Policy) -> None:
        if not isinstance(policy, ConvPolicy):
            raise ParameterError(
                f"embedding {type(self).__name__} needs a policy with convolutions, "
                f"cnn or paper-cnn, not {type(policy).__name__}; use the embedding 'pixels'"
            )
        self.policy = policy


@final
class Penultimate(_ConvolutionalEmbedding):
    """The network's last layer before the logits, as in the paper; collapses, kept to compare."""

    def vectors(self, images: Images) -> NDArray[np.float32]:
        """(n, hidden[-1])."""
        return self.policy.penultimate(images).numpy()


class PooledConvolutions(_ConvolutionalEmbedding):
    """Every convolution layer's output averaged over a 4x4 grid, one after the other.

    With channels (16, 32, 32) these are 1280 numbers.
    """

    side = 4

    def vectors(self, images: Images) -> NDArray[np.float32]:
        """(n, sum(channels) * 16)."""
        layers = self.policy.activations(images)
        return np.concatenate([_averaged(layer, self.side) for layer in layers], axis=1)


@final
class RandomConvolutions(PooledConvolutions):
    """As `PooledConvolutions`, in a network of the policy's shape that never learned anything.

    What is left of the policy is its architecture: kept to compare, since a gate need not look
    through what was trained for the action. The weights come from a fixed seed.
    """

    def attach(self, policy: Policy) -> None:
        """Look through a random network of the policy's shape from now on."""
        super().attach(policy)
        self.policy = self.policy.untrained(seed_for("random convolutions"))


@final
class FovealConvolutions(_ConvolutionalEmbedding):
    """The last convolution layer around the middle of the image, at its own resolution.

    For cameras that move with the robot: what decides the next action is near, and there a metre
    counts, while the far field is new in every scene and drowns it. In the driving task, whose last
    layer is 6x6, these are the 2x2 cells that see 7 m around the car: 128 numbers.
    """

    def vectors(self, images: Images) -> NDArray[np.float32]:
        """(n, channels[-1] * cells)."""
        return _middle(self.policy.activations(images)[-1])


@final
class TwoScaleConvolutions(_ConvolutionalEmbedding):
    """The last layer around the middle, and the first one's whole view averaged over a 6x6 grid.

    The middle alone misses a robot that stands askew, which the course of the road far off shows;
    the first layer shows it as it is, not as the policy reads it. With channels (16, 32, 32) in the
    driving task 128 + 576 numbers.
    """

    side = 6

    def vectors(self, images: Images) -> NDArray[np.float32]:
        """(n, channels[-1] * cells + channels[0] * 36)."""
        layers = self.policy.activations(images)
        return np.concatenate([_middle(layers[-1]), _averaged(layers[0], self.side)], axis=1)


def _averaged(layer: torch.Tensor, side: int) -> NDArray[np.float32]:
    """(n, c * side²) what a layer shows in each cell of a square grid, on average."""
    return functional.adaptive_avg_pool2d(layer, side).flatten(1).numpy()


def _middle(layer: torch.Tensor) -> NDArray[np.float32]:
    """(n, c * cells) a layer's cells around the middle of the image."""
    top, left = (round(side * (1 - MIDDLE) / 2) for side in layer.shape[2:])
    middle = layer[:, :, top : layer.shape[2] - top, left : layer.shape[3] - left]
    return middle.flatten(1).numpy()
