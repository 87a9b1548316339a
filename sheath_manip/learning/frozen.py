"""Fits a gate to a policy that stays as it is, from recorded episodes alone."""

from collections.abc import Iterable
from dataclasses import replace
from itertools import chain

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.gates.config import GateConfig, planned_signal
from sheath_manip.gates.fitted import Sources
from sheath_manip.gates.making import GATES
from sheath_manip.learning.fitting import Fit, Looks, fit_to_looks
from sheath_manip.learning.frozen_settings import SUITED
from sheath_manip.policies.latent import latent_of
from sheath_manip.policies.looking import end_to_end
from sheath_manip.policies.looking_along import look_along
from sheath_manip.policies.readings import require_cameras
from sheath_manip.protocols import PredictingPolicy
from sheath_manip.rollout.guard import ask
from sheath_manip.signals import make_signal
from sheath_manip.types import Episode, TaskSpec


def fit_frozen_gate(
    policy: PredictingPolicy,
    states: Iterable[Episode],
    held_out: Iterable[Episode],
    config: GateConfig,
    spec: TaskSpec,
    *,
    sources: Sources,
) -> Fit:
    """Fit the gate of `policy` to the labelled steps of `states`, its threshold to `held_out`.

    The policy looks along each episode as if it drove, so that what it keeps from step to step, or
    plans ahead, is as under the gate. Each episode is read when its turn comes, and let go.

    Args:
        policy: which nothing is changed of.
        states: expert episodes, with at least one labelled step each: those that the policy was
            trained on, or others alike.
        held_out: expert episodes besides.
        config: names signal, embeddings, support and rule; where it says `suited`, what suits
            policy and data.
        spec: of what is recorded.
        sources: the names of all these episodes.

    Raises ParameterError where the signal cannot be fitted to this policy.
    """
    if not GATES[config.kind].looks:
        raise ParameterError(
            f"a gate of kind {config.kind!r} judges by nothing that could be fitted; wanted "
            "support: --gate.kind support"
        )
    coming = iter(states)
    first = next(coming, None)
    if first is None:
        raise ParameterError("there is no episode to fit to; wanted at least one")
    if not spec.cameras and not first.columns.features.size:
        raise ParameterError(
            "the episodes hold nothing that is observed, no image and no feature; wanted some, "
            "such as --keys features=KEY of a file that another tool wrote"
        )
    config = _suited(config, policy, first, spec)
    signal = make_signal(planned_signal(config))
    if signal.uses_displaced:
        raise ParameterError(
            f"the embeddings {config.embedding} and {config.precedent_embedding} look through "
            "convolutions of the house's policies; wanted latent, pixels-whitened, "
            "pixels-and-features or scaled-features: --gate.embedding, --gate.precedent-embedding"
        )
    readers = signal.attach(policy)
    require_cameras(readers, spec)
    labels, seen = [], []
    for episode in chain([first], coming):
        labels.append(episode.columns.labels[episode.columns.has_label])
        seen.append(look_along(policy, episode, readers))
    calibration = [look_along(policy, episode, readers) for episode in held_out]
    looks = Looks(np.concatenate(labels), end_to_end(seen), calibration)
    return Fit(fit_to_looks(policy, signal, looks, config, sources=sources), looks)


def _suited(
    config: GateConfig, policy: PredictingPolicy, example: Episode, spec: TaskSpec
) -> GateConfig:
    """`config` with what suits policy and data in place of `suited`.

    The support is estimated on the policy's latent where it gives one, else on what is observed;
    precedents are looked for in what is observed, which is as new at each step of a chunk.
    """
    choices = spec.action.choices is not None
    observed = _of_what_is_observed(example, spec)
    proposal = ask("policy", policy.predict, example.steps[0].observation.alone)
    inside = observed if latent_of(proposal.latents) is None else "latent"
    by = {"signal": "joined" if choices else "near-joined"}
    by |= {"embedding": inside, "precedent_embedding": observed}
    return replace(config, **{k: v for k, v in by.items() if getattr(config, k) == SUITED})


def _of_what_is_observed(example: Episode, spec: TaskSpec) -> str:
    features = example.columns.features
    if spec.cameras:
        return "pixels-and-features" if features.size else "pixels-whitened"
    return "features" if np.isin(features, (0, 1)).all() else "scaled-features"
