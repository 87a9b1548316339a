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
    and the pixels of the middle        .99   1.00    .99    .99    .91

Two more, on other tuning scenes, of embeddings that a control loop can afford. The last columns
are the gate `joined`, with precedents in the foveal embedding beside that support: mistakes, and
windows before failures from failure-free ones.

                                      3.5 m    45°  front  mistakes    joined
    convolutions and pixels (1904)      .99    .99    .99   .92 .85   .932 .885   .940 .927
    two-scale (704)                     .98    .99    .97   .90 .84   .932 .884   .933 .913
    two-scale contrasts (384)           .99    .99    .99   .90 .86   .927 .888   .945 .908

The precedents' mistakes alone: .920 and .881 with all 87 foveal directions, .920 and .876 with the
32 strongest, .911 and .865 with 16.
"""

from typing import final

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.cnn import ConvPolicy
from sheath_manip.policies.embeddings import ScaledEmbedding
from sheath_manip.policies.readings import (
    INSTEAD,
    Latent,
    LayerOnGrid,
    MiddleOfLastLayer,
    ThroughAnotherPolicy,
)
from sheath_manip.policies.scaling import Scaling
from sheath_manip.protocols import PredictingPolicy, Reader
from sheath_manip.seeding import seed_for


@final
class Penultimate(ScaledEmbedding):
    """The network's last layer before the logits, as in the paper; collapses, kept to compare."""

    def readers(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """(n, hidden[-1])."""
        del policy
        return (Latent("penultimate"),)


@final
class PooledConvolutions(ScaledEmbedding):
    """Every convolution layer's output averaged over a 4x4 grid, one after the other.

    With channels (16, 32, 32) these are 1280 numbers.
    """

    side = 4

    def readers(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """(n, sum(channels) * 16)."""
        return _pooled(policy, type(self).__name__, self.side)


@final
class RandomConvolutions(ScaledEmbedding):
    """`PooledConvolutions` of a network of the policy's shape that never learned anything.

    What is left of the policy is its architecture: kept to compare, since a gate need not look
    through what was trained for the action. The weights come from a fixed seed.
    """

    side = 4

    def readers(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """(n, sum(channels) * 16)."""
        pooled = _pooled(policy, type(self).__name__, self.side)
        assert isinstance(policy, ConvPolicy)
        random = policy.untrained(seed_for("random convolutions"))
        return (ThroughAnotherPolicy(random, pooled),)


@final
class FovealConvolutions(ScaledEmbedding):
    """The last convolution layer around the middle of the image, at its own resolution.

    For cameras that move with the robot: what decides the next action is near, and there a metre
    counts, while the far field is new in every scene and drowns it. In the driving task, whose last
    layer is 6x6, these are the 2x2 cells that see 7 m around the car: 128 numbers.
    """

    def readers(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """(n, channels[-1] * cells)."""
        del policy
        return (MiddleOfLastLayer(),)


@final
class TwoScaleConvolutions(ScaledEmbedding):
    """The last layer around the middle, and the first one's whole view averaged over a grid.

    The middle alone misses a robot that stands askew, which the course of the road far off shows;
    the first layer shows it as it is, not as the policy reads it. With channels (16, 32, 32) in the
    driving task 128 + 576 numbers.
    """

    def __init__(self, scaling: Scaling | None = None, side: int = 6) -> None:
        """Store the scaling, standardised where None, and the cells of the grid each way."""
        super().__init__(scaling)
        self.side = side

    def readers(self, policy: PredictingPolicy) -> tuple[Reader, ...]:
        """(n, channels[-1] * cells + channels[0] * side²)."""
        del policy
        return MiddleOfLastLayer(), LayerOnGrid(0, self.side)


def _pooled(policy: PredictingPolicy, name: str, side: int) -> tuple[Reader, ...]:
    if not isinstance(policy, ConvPolicy):
        raise ParameterError(
            f"embedding {name} needs a policy with convolutions, cnn or paper-cnn, not "
            f"{type(policy).__name__}; use {INSTEAD}"
        )
    return tuple(LayerOnGrid(number, side) for number in range(len(policy.channels)))
