"""A torch module that was trained elsewhere, and what a layer of it shows."""

import numpy as np
import pytest
import torch

from sheath_manip.adapters.from_torch import from_torch
from sheath_manip.exceptions import ParameterError
from sheath_manip.policies import make_embedding
from sheath_manip.types import Observations, Proposal
from tests.toy import ACTION, CHOICES


def network(outputs: int = 1) -> torch.nn.Sequential:
    torch.manual_seed(0)
    hidden = torch.nn.Sequential(torch.nn.Linear(2, 8), torch.nn.ReLU())
    return torch.nn.Sequential(hidden, torch.nn.Dropout(0.5), torch.nn.Linear(8, outputs))


def states(count: int = 5) -> Observations:
    features = np.random.default_rng(0).normal(size=(count, 2)).astype(np.float32)
    features.flags.writeable = False
    images = np.zeros((count, 4, 4, 3), np.uint8)
    return Observations({"top": images}, features, ("fold",) * count)


def test_it_proposes_what_the_module_says_without_dropout_and_the_layer_is_a_latent() -> None:
    module, seen = network(), states()
    layer = module.get_submodule("0.0")
    policy = from_torch(module, embed="0.0")
    # As one who trains on would leave it.
    module.train()
    proposal = policy.predict(seen)
    np.testing.assert_array_equal(policy.predict(seen).actions, proposal.actions)
    with torch.no_grad():
        inside = layer(torch.tensor(seen.features))
        expected = module(torch.tensor(seen.features))
    np.testing.assert_array_equal(proposal.actions, expected.numpy())
    np.testing.assert_array_equal(proposal.latents["latent"], inside.numpy())
    alone = policy.propose(seen.rows(slice(1, 2)))
    np.testing.assert_allclose(alone.latents["latent"][0], inside[1].numpy(), atol=1e-6)
    # Nothing is left behind in the module.
    assert not layer._forward_hooks


def test_choices_are_chosen_by_their_scores() -> None:
    policy = from_torch(network(3), embed="0", action=ACTION)
    proposal = policy.predict(states())
    scores = np.asarray(proposal.latents["choice scores"])
    np.testing.assert_array_equal(proposal.now, CHOICES[scores.argmax(1)])
    assert policy.surrogate_losses(proposal, proposal.now).max() == 0


def test_inputs_and_outputs_are_the_users_to_say() -> None:
    class Speaking(torch.nn.Module):
        def forward(self, images, *, told=None, more=0):
            assert images.dtype is torch.uint8
            return {"chunk": torch.full((len(images), 4, 2), float(len(told or "")) + more)}

    module, seen = Speaking(), states()
    positional = from_torch(
        module, inputs=lambda o: o.images["top"], outputs=lambda out: out["chunk"]
    )
    assert positional.propose(seen.rows(slice(0, 1))).actions.shape == (1, 4, 2)
    named = from_torch(
        module,
        inputs=lambda o: {"images": o.images["top"], "told": (o.instructions or ("",))[0]},
        outputs=lambda out: out["chunk"].numpy(),
    )
    assert named.predict(seen).now[0, 0] == 4
    several = from_torch(
        torch.nn.Bilinear(2, 2, 1), inputs=lambda o: (o.features, torch.tensor(o.features))
    )
    assert several.predict(seen).now.shape == (5, 1)


def test_a_history_is_an_axis_of_what_the_module_is_called_with() -> None:
    module = torch.nn.Sequential(torch.nn.Flatten(), torch.nn.Linear(6, 1))
    policy = from_torch(module, embed="1", history=3)
    policy.reset(np.random.default_rng(0))
    seen = states()
    proposals = [policy.propose(seen.rows(slice(t, t + 1))) for t in range(3)]
    with torch.no_grad():
        expected = module(torch.tensor(seen.features[None, :3]))
    np.testing.assert_allclose(proposals[-1].now, expected.numpy(), atol=1e-6)


@pytest.mark.parametrize(
    ("embed", "says"),
    [("hiden", r"no layer 'hiden'; wanted one of 0, 0\.0.*"), ("", "no layer ''")],
)
def test_a_layer_that_there_is_not_is_told_at_once(embed: str, says: str) -> None:
    with pytest.raises(ParameterError, match=says):
        from_torch(network(), embed=embed)


def test_a_layer_that_cannot_be_read_is_told_in_a_look() -> None:
    class Idle(torch.nn.Module):
        def __init__(self) -> None:
            super().__init__()
            self.used = torch.nn.LSTM(2, 3, batch_first=True)
            self.unused = torch.nn.Linear(2, 2)
            self.mean = torch.nn.Flatten(0)

        def forward(self, features):
            self.mean(features)
            return self.used(features[:, None])[0][:, 0]

    # Of what gives several things the first is taken.
    seen = states()
    latent = from_torch(Idle(), embed="used").predict(seen).latents["latent"]
    assert np.shape(latent) == (5, 1, 3)
    with pytest.raises(ParameterError, match="'unused' did not run"):
        from_torch(Idle(), embed="unused").predict(seen)
    with pytest.raises(ParameterError, match=r"'mean' gives \(10,\) for 5 states; wanted a tensor"):
        from_torch(Idle(), embed="mean").predict(seen)


def test_the_embedding_reads_the_only_latent_whatever_its_name_and_shape() -> None:
    (reader,) = make_embedding("latent").attach(from_torch(network()))
    seen, numbers = states(), np.arange(60, dtype=np.float32).reshape(5, 3, 4)
    actions = np.zeros((5, 1), np.float32)
    np.testing.assert_array_equal(
        reader(seen, Proposal(actions, {"mine": numbers})), numbers.reshape(5, 12)
    )
    both = {"mine": numbers, "latent": numbers[:, :1]}
    assert reader(seen, Proposal(actions, both)).shape == (5, 4)
    with pytest.raises(ParameterError, match="gives none; wanted one, as `from_torch"):
        reader(seen, Proposal(actions))
    with pytest.raises(ParameterError, match=r"gives several \(a, b\), none called 'latent'"):
        reader(seen, Proposal(actions, {"a": numbers, "b": numbers}))
