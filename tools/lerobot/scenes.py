"""Episodes of the state task: the expert's, a policy's alone, and those under a gate."""

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.gates.constant import AlwaysExpert, AlwaysPolicy
from sheath_manip.protocols import Gate, Policy
from sheath_manip.rollout.loop import rollout
from sheath_manip.seeding import generator, scene_seed
from sheath_manip.tasks.grasp_clutter.expert import GraspExpert
from sheath_manip.types import Action, Episode, EpisodeInfo, Observation, Purpose, Transition
from tools.lerobot.state_task import DIFFICULTIES, StateEnvironment


class Noting(StateEnvironment):
    """Keeps a note of each action that it was given."""

    def reset(self, seed: int) -> Observation:
        """Begin an episode."""
        self.given: list[Action] = []
        return super().reset(seed)

    def step(self, action: Action) -> Transition:
        """Run one control step."""
        self.given.append(action.copy())
        return super().step(action)


class Scenes:
    """One environment, and the episodes in it that follow from a seed."""

    def __init__(self, variant: str, seed: int) -> None:
        self.variant, self.seed = variant, seed
        self.environment = Noting(DIFFICULTIES[variant])
        self.expert = GraspExpert(self.environment.inner)
        self.spec = self.environment.spec
        self.robot = len(self.environment.robot_names)

    def shown(self, purpose: Purpose, count: int, number: int = 0) -> list[Episode]:
        """Return so many episodes that the expert drives, every step labelled."""
        infos = [self.info(purpose, "expert", number, index) for index in range(count)]
        return [self.run(info, AlwaysExpert(), None) for info in infos]

    def alone(self, policy: Policy, method: str, number: int, count: int) -> list[Episode]:
        """Return so many episodes that the policy drives; the scenes are always the same."""
        infos = [self.info(Purpose.EVALUATION, method, number, index) for index in range(count)]
        return [self.run(info, AlwaysPolicy(), policy) for info in infos]

    def record(
        self, store: EpisodeStore, policy: Policy, gate: Gate, method: str, number: int, index: int
    ) -> None:
        """Run a round's episode, unless `store` has it; all methods meet the same scenes."""
        info = self.info(Purpose.LEARNING, method, number, index)
        if not store.has(info):
            store.append(self.run(info, gate, policy))

    def info(self, purpose: Purpose, method: str, number: int, index: int) -> EpisodeInfo:
        """Return where an episode comes from."""
        # Evaluation's scenes are the same after every round.
        scene = (number if purpose is Purpose.LEARNING else 0, index)
        return EpisodeInfo.of(
            self.spec,
            variant=self.variant,
            seed=scene_seed(purpose, "lerobot", self.seed, *scene),
            purpose=purpose,
            method=method,
            round=number,
            index=index,
            run_seed=self.seed,
            checkpoint="" if method == "expert" else f"{method}-{number}",
        )

    def run(self, info: EpisodeInfo, gate: Gate, policy: Policy | None) -> Episode:
        """Return one episode."""
        return rollout(
            self.environment,
            info,
            gate,
            rng=generator("lerobot", info.seed, info.method),
            policy=policy,
            expert=self.expert,
        )
