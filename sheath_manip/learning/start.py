"""What all methods of one training seed begin with."""

from collections.abc import Sequence
from dataclasses import dataclass

from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.checkpoints import Checkpoints
from sheath_manip.types.samples import Samples


@dataclass(frozen=True, eq=False)
class SharedStart:
    """What all methods of one training seed share: they start from the same policy."""

    checkpoint: Checkpoint
    checkpoints: Checkpoints
    demonstrations: Samples
    names: Sequence[str]
    """of the demonstrations"""
    check: Sequence[Samples]
    """one a further held-out expert episode, for measuring false alarms"""
