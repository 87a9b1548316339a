"""Looking at a recorded episode step by step, as a policy would that drove in its states."""

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import PredictingPolicy, Reader
from sheath_manip.rollout.guard import ask
from sheath_manip.seeding import generator
from sheath_manip.types import Episode
from sheath_manip.types.seen import Seen


def look_along(
    policy: PredictingPolicy, episode: Episode, readers: tuple[Reader, ...] = ()
) -> Seen:
    """Return the labelled states of `episode` as `policy` sees them one after another.

    One that keeps a history or plays chunks of actions sees another thing in the middle of an
    episode than `look` would show, which knows each state alone. The surrogate losses are those of
    what it would have proposed. Raises ParameterError where its actions have another size than the
    labels, and SheathError where it breaks down.
    """
    policy.reset(generator("looking along"))
    labels, chosen = episode.columns.labels, episode.columns.has_label
    actions, losses = [], []
    rows: dict[Reader, list[np.ndarray]] = {reader: [] for reader in readers}
    for step, label, labelled in zip(episode.steps, labels, chosen, strict=True):
        observation = step.observation.alone
        proposal = ask("policy", policy.propose, observation)
        if proposal.now.shape != (1, len(label)):
            raise ParameterError(
                f"the policy proposes {proposal.now.shape} where the episode's labels have "
                f"{len(label)} numbers; wanted (1, {len(label)})"
            )
        if not labelled:
            continue
        actions.append(proposal.now)
        losses.append(policy.surrogate_losses(proposal, label[None]))
        for reader, read in rows.items():
            read.append(reader(observation, proposal))
    if not actions:
        raise ParameterError("an episode without a label has nothing to look at; leave it out")
    return Seen(
        episode.columns.features[chosen].astype(np.float32),
        np.concatenate(actions),
        {reader: np.concatenate(read) for reader, read in rows.items()},
        np.concatenate(losses),
    )
