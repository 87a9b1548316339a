"""The option of verbs that fit policies and gates, or let them judge: on which device."""

from dataclasses import dataclass
from typing import Annotated

from sheath_manip.cli.options import default_is
from sheath_manip.rollout.device import use_device


@dataclass(frozen=True)
class Computing:
    """Where policies and gates compute."""

    device: Annotated[str | None, default_is("SHEATH_DEVICE, or cpu")] = None
    """device that policies, embeddings, supports and the search for precedents compute on: cpu,
    which is the reference to the bit, cuda, cuda:N, or auto, which is cuda where there is one"""

    def begin(self) -> None:
        """Let this process and its workers compute there.

        Raises ParameterError for what is no device, and SetupError for one that is not here.
        """
        use_device(self.device)
