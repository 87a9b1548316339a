"""What may drive an episode: an expert, a policy under its gate, or a policy alone."""

from dataclasses import dataclass, field
from pathlib import Path

from sheath_manip.gates import AlwaysExpert, AlwaysPolicy, AttentivePerson
from sheath_manip.learning.checkpoint import load_checkpoint
from sheath_manip.protocols import Environment, Policy
from sheath_manip.rollout.action_noise import DisturbedExpert
from sheath_manip.rollout.cached_expert import CachedExpert
from sheath_manip.rollout.request import Crew
from sheath_manip.rollout.simulated_operator import (
    OperatorConfig,
    OperatorHand,
    SimulatedOperator,
)
from sheath_manip.task import SCRIPTED, Task


@dataclass(frozen=True)
class ExpertAlone:
    """An expert, or a fallback controller by its name; every step is labelled."""

    name: str = SCRIPTED

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Make the expert of `environment`."""
        return Crew(AlwaysExpert(), expert=task.make_expert(environment, self.name))


@dataclass(frozen=True)
class NoisyExpert:
    """The scripted expert, executed with noise and labelled without it (DART)."""

    noise: float
    """standard deviation, as a share of half the actions' range"""

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Make the expert of `environment`, and what pushes it about."""
        expert = CachedExpert(task.make_expert(environment))
        noisy = DisturbedExpert(expert, environment.spec.action, self.noise)
        return Crew(AlwaysPolicy(query=True), noisy, expert)


@dataclass(frozen=True)
class GatedPolicy:
    """A policy under the gate of its checkpoint, with an expert to take over."""

    checkpoint: Path
    digest: str
    """of its file: another one at the same place is another driver"""
    expert: str = SCRIPTED
    """the expert, or a fallback controller by its name"""
    watched_by: OperatorConfig | None = field(default_factory=OperatorConfig)
    """the simulated person who watches, for gates that leave it to one when to take over; None:
    nobody does"""

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Read the checkpoint, and make its gate and the expert."""
        checkpoint = load_checkpoint(self.checkpoint, environment.spec)
        expert = CachedExpert(task.make_expert(environment, self.expert))
        config = checkpoint.fitted.config
        if self.watched_by is None or config.kind != "human":
            gate = checkpoint.gate()
            return Crew(gate, checkpoint.policy, expert, hindsight_s=config.hindsight_s)
        spec, operator = environment.spec, SimulatedOperator(self.watched_by)
        gate = checkpoint.gate(person=AttentivePerson(expert, spec, operator))
        hand = OperatorHand(expert, operator, spec.action, spec.control_rate_hz)
        return Crew(gate, checkpoint.policy, CachedExpert(hand), hindsight_s=config.hindsight_s)


@dataclass(frozen=True)
class PolicyAlone:
    """The policy of a checkpoint, ungated; nobody labels."""

    checkpoint: Path
    digest: str
    """of its file"""

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Read the checkpoint."""
        del task
        return Crew(AlwaysPolicy(), load_checkpoint(self.checkpoint, environment.spec).policy)


@dataclass(frozen=True, eq=False)
class GivenPolicy:
    """A policy that lies in no file, ungated; nobody labels."""

    policy: Policy

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Take the policy as it is."""
        del task, environment
        return Crew(AlwaysPolicy(), self.policy)
