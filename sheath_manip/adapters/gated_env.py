"""A gate around any training loop: what is stepped is a proposal, and the gate says who acts."""

from typing import Any

import gymnasium

from sheath_manip.adapters.judged_by import GateLike, judged_by
from sheath_manip.adapters.stepped import HandedPolicy, SteppedEnvironment
from sheath_manip.adapters.task_env import SCENE, TaskEnv
from sheath_manip.exceptions import ParameterError, UnattendedError
from sheath_manip.protocols import Expert, PredictingPolicy
from sheath_manip.rollout.actors import Actors
from sheath_manip.rollout.audience import Audience
from sheath_manip.rollout.cached_expert import CachedExpert
from sheath_manip.rollout.cutting_short import cut_short
from sheath_manip.rollout.deciding import GuardedGate, GuardedPolicy
from sheath_manip.rollout.guard import BrokenError, built
from sheath_manip.rollout.loop import control_step
from sheath_manip.rollout.stage import Stage
from sheath_manip.rollout.stepping import Stepping
from sheath_manip.rollout.telling import Telling
from sheath_manip.seeding import generator
from sheath_manip.task import HOLD, SCRIPTED
from sheath_manip.types import Actor, EpisodeInfo, Purpose

METHOD = "gated-env"


class GatedEnv(gymnasium.Wrapper):
    """Steps as the one control loop does: the action is a proposal, which the gate judges.

    Where it does not trust it, the expert acts in its place; where gate, policy or expert fail, who
    acts is who acts in every run of this framework (docs/reliability.md), without deadlines. The
    info says of each step:

    - `proposed`, `requested` (by who acted), `executed` (what was commanded in the end), and
      `labelled` (the expert's, None where it was not asked), all as actions of the space;
    - `actor`, `reason`, `score` and `threshold` of the gate's decision, and what was `broken`.
    """

    def __init__(
        self,
        env: gymnasium.Env,
        gate: GateLike,
        *,
        expert: Expert | str = SCRIPTED,
        looks: PredictingPolicy | None = None,
    ) -> None:
        """Put `gate` around `env`.

        Args:
            env: of `to_gymnasium` or `gymnasium.make("sheath/…")`, wrapped or not; one of another
                package gets there by `to_gymnasium(from_gymnasium(…))`.
            gate: what judges: a checkpoint or its file, what `fit_gate` gives, or any object with
                `reset(rng)` and `decide(observation, proposal)`.
            expert: who acts where the gate says so, and labels: a name that the task has, or an
                object with `reset()` and `act(observation)`, which sees what the task shows.
            looks: a policy whose latents of each observation the gate is shown beside the action;
                by default the one that the gate was fitted around, where it needs one.

        Raises ParameterError where the gate cannot judge such proposals, UnknownNameError for an
        expert that there is not, and CheckpointError.
        """
        super().__init__(env)
        inside = env.unwrapped
        if not isinstance(inside, TaskEnv):
            raise ParameterError(
                f"GatedEnv goes around a task's environment, not {type(inside).__name__}; wanted "
                "that of to_gymnasium(from_gymnasium(…)), or gymnasium.make('sheath/…')"
            )
        if env.action_space != inside.action_space:
            raise ParameterError(
                f"wrappers made the actions {env.action_space}; wanted those of the task, "
                f"{inside.action_space}: put such wrappers around GatedEnv"
            )
        self.task_env = inside
        judged = judged_by(gate, inside.task_spec, looks)
        named = isinstance(expert, str)
        acts = inside.task.make_expert(inside.environment, expert) if named else expert
        self._handed = HandedPolicy(inside.spaces, judged.looks)
        self._stepped = SteppedEnvironment(env, inside)
        self._policy = GuardedPolicy(self._handed, inside.task_spec.action)
        self._gate = GuardedGate(judged.gate)
        self._actors = Actors(
            {Actor.EXPERT: CachedExpert(acts)},
            built(HOLD, inside.task.make_hold, inside.environment),
            inside.task_spec.action,
        )
        self._info: EpisodeInfo | None = None
        self._stepping: Stepping | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Any, dict[str, Any]]:
        """Start an episode, as the environment inside does: the seed is the scene's."""
        scene = (options or {}).get(SCENE, seed)
        if scene is None:
            scene = self.task_env.draw_scene()
        self._stepped.asked = {"seed": seed, "options": {**(options or {}), SCENE: scene}}
        inside = self.task_env
        self._info = EpisodeInfo.of(
            inside.task_spec,
            variant=inside.variant,
            seed=scene,
            purpose=Purpose.LEARNING,
            method=METHOD,
        )
        self._stepping = None
        stepping = Stepping(Stage(self._stepped), Audience(()), Telling(self._info))
        stepping.begin(scene)
        # As in `rollout`: the policy's draws apart from the gate's.
        rng = generator(METHOD, scene)
        self._policy.reset(rng.spawn(1)[0])
        self._gate.reset(rng)
        self._actors.reset()
        self._stepping = stepping
        return self._stepped.seen, self._stepped.info

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Run one control step; what is no action of the space is an invalid proposal.

        Args:
            action: what the learner's policy proposes: an action of the space, or a `Proposal` with
                the latents that the gate's embeddings take.

        Raises ParameterError where no episode is under way, and AttemptError where nobody is left
        to act or the environment fails: then the robot was told to hold.
        """
        if self._stepping is None or self._stepping.over:
            raise ParameterError("no episode is under way; wanted reset() first")
        stepping, self._handed.handed = self._stepping, action
        try:
            control_step(stepping, self._policy, self._gate, self._actors)
        except (BrokenError, ParameterError, UnattendedError) as error:
            assert self._info is not None
            self._stepping = None
            raise cut_short(stepping, self._actors, self._info, error) from error
        info = {**self._stepped.info, **self._told(stepping)}
        return (
            self._stepped.seen,
            self._stepped.reward,
            stepping.terminated,
            stepping.truncated,
            info,
        )

    def _told(self, stepping: Stepping) -> dict[str, Any]:
        step = stepping.steps[-1]
        shown = self.task_env.spaces.shown
        decision = step.decision
        return {
            "proposed": None if step.proposed is None else shown(step.proposed),
            "requested": shown(step.requested),
            "executed": shown(step.executed),
            "labelled": None if step.labelled is None else shown(step.labelled),
            "actor": str(decision.actor),
            "reason": str(decision.reason),
            "score": decision.score,
            "threshold": decision.threshold,
            "broken": [f"{each.who}: {each.what}" for each in decision.broken],
        }
