"""What a task is learned with where nobody has said: policy, signal and embeddings that suit it."""

from dataclasses import replace

from sheath_manip.gates.config import GateConfig
from sheath_manip.learning.config import LearningPlan
from sheath_manip.policies.config import PolicyConfig
from sheath_manip.types import TaskSpec

EVERYBODYS = GateConfig()
"""its signal and embeddings are those of choices and of one camera"""
BLIND = ("mlp", "linear-svm", "linear-svm-paper")
"""policies of the house that look at features alone"""
THROUGH_CAMERAS = ("spatial-cnn", "act")


def suited(spec: TaskSpec, plan: LearningPlan) -> tuple[LearningPlan, str]:
    """Return `plan` with what suits the task in place of defaults that cannot, and a line on it.

    A policy, a signal or an embedding that is not the default was chosen by somebody, and stays. So
    does the gate where only one of its three is the default. The line is empty where nothing is
    exchanged.
    """
    policy = _policy(spec, plan.policy)
    gate = _gate(spec, policy, plan.gate)
    if (policy, gate) == (plan.policy, plan.gate):
        return plan, ""
    line = (
        f"for {spec.name}: policy {policy.name}, signal {gate.signal}, embedding {gate.embedding}; "
        "others by --policy.name, --gate.signal, --gate.embedding, --gate.precedent-embedding"
    )
    return replace(plan, policy=policy, gate=gate), line


def _policy(spec: TaskSpec, policy: PolicyConfig) -> PolicyConfig:
    if policy != PolicyConfig():
        return policy
    if not spec.cameras and spec.feature_names:
        return PolicyConfig("mlp")
    if spec.cameras and spec.action.choices is None:
        return PolicyConfig("spatial-cnn")
    return policy


def _gate(spec: TaskSpec, policy: PolicyConfig, gate: GateConfig) -> GateConfig:
    looks = gate.signal, gate.embedding, gate.precedent_embedding
    if looks != (EVERYBODYS.signal, EVERYBODYS.embedding, EVERYBODYS.precedent_embedding):
        return gate
    if not spec.cameras or policy.name in BLIND:
        embedding = "scaled-features"
    elif policy.name in THROUGH_CAMERAS:
        embedding = "camera-convolutions-whitened"
    else:
        return gate
    signal = "near-joined" if spec.action.choices is None else gate.signal
    return replace(gate, signal=signal, embedding=embedding, precedent_embedding=embedding)
