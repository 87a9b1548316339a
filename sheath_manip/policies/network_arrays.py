"""What passes between arrays and a network: images, and its weights."""

from collections.abc import Callable
from typing import TypeVar, cast

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from sheath_manip.exceptions import ParameterError
from sheath_manip.policies.learned_arrays import require_shapes
from sheath_manip.policies.network import shapes_of
from sheath_manip.protocols import Arrays
from sheath_manip.rollout.device import is_cpu, torch_device

Network = TypeVar("Network", bound=nn.Module)


def tensor_of(array: NDArray, network: nn.Module) -> torch.Tensor:
    """The array where `network` is; a copy where it is read-only, which torch would warn of."""
    tensor = torch.from_numpy(array if array.flags.writeable else array.copy())
    return tensor.to(device_of(network), non_blocking=True)


def device_of(network: nn.Module) -> torch.device:
    """Return where the weights of a network are, whose last layer is its `head`."""
    # A control loop asks for it, and to list all weights takes four times as long.
    return cast(nn.Linear, network.head).weight.device


def placed(network: Network) -> Network:
    """Return the network, moved to where this process computes."""
    return network if is_cpu() else network.to(torch_device())


def weights_of(network: nn.Module) -> dict[str, NDArray]:
    """Return a copy of a network's weights, by layer."""
    state = network.state_dict()
    return {name: tensor.cpu().contiguous().numpy().copy() for name, tensor in state.items()}


def network_with(weights: Arrays, fresh: Callable[[bool], Network], what: str) -> Network:
    """Return a network that took over `weights`, ready to predict.

    Args:
        weights: as `weights_of` gave them.
        fresh: makes the network, with first weights or, called with False, with their shapes only.
        what: the network is, for the message.

    Raises:
        ParameterError: the weights belong to a network of another shape.
    """
    try:
        # Before memory is taken for what the hyperparameters ask for.
        require_shapes(weights, shapes_of(fresh(False)))
    except ParameterError as error:
        raise ParameterError(f"the weights are not those of a network with {what}: {error}") from (
            error
        )
    network = fresh(True)
    network.load_state_dict(
        {name: torch.from_numpy(np.array(array)) for name, array in weights.items()}
    )
    return placed(network).eval()
