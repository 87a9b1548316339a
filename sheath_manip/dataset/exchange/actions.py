"""The actions of an episode that are no array of `layout`, but follow from those that are."""

import numpy as np
from numpy.typing import NDArray

from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.recorded import Recorded
from sheath_manip.types import Actor

REQUESTED = "requested"
"""the array's name in every format"""


def requested(recorded: Recorded) -> NDArray[np.float32]:
    """(T, a) what the actor asked for: given to the environment, it runs the episode again.

    As `Step.requested`; where no command filter lies in between, that is what was executed.
    """
    header, arrays = recorded.header, recorded.arrays
    policy = [place for place, actor in enumerate(header.actors) if actor is Actor.POLICY]
    by_policy = np.isin(arrays["actor"], policy)[:, None]
    asked = np.where(by_policy, arrays["proposed"], arrays["labelled"])
    known = np.where(by_policy[:, 0], arrays["has_proposed"], arrays["has_labelled"])
    return np.where(known[:, None], asked, arrays["executed"])


def chosen(recorded: Recorded, choice: ActionChoice) -> NDArray[np.float32]:
    """(T, a) the action that stands for `the` action in formats that know one."""
    if choice is ActionChoice.REQUESTED:
        return requested(recorded)
    return recorded.arrays[choice]
