"""What may drive an episode: an expert, a policy under its gate, or a policy alone."""

from dataclasses import dataclass
from pathlib import Path

from sheath_manip.gates import AlwaysExpert, AlwaysPolicy, attentive_person
from sheath_manip.learning.checkpoint import load_checkpoint
from sheath_manip.protocols import Environment, Policy
from sheath_manip.rollout.action_noise import DisturbedExpert
from sheath_manip.rollout.cached_expert import CachedExpert
from sheath_manip.rollout.request import Crew
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
    attended: bool = True
    """whether an attentive person watches, for gates that ask one when to take over"""

    def crew(self, task: Task, environment: Environment) -> Crew:
        """Read the checkpoint, and make its gate and the expert."""
        checkpoint = load_checkpoint(self.checkpoint, environment.spec)
        expert = CachedExpert(task.make_expert(environment, self.expert))
        person = attentive_person(expert, environment.spec.action) if self.attended else None
        gate = checkpoint.gate(person=person)
        hindsight_s = checkpoint.fitted.config.hindsight_s
        return Crew(gate, checkpoint.policy, expert, hindsight_s=hindsight_s)


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
