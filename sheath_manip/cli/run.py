"""`sheath run`: a policy under its gate, with an expert or a stand-in to take over."""

from dataclasses import dataclass, field
from pathlib import Path

from sheath_manip.cli.options import Address, TaskName
from sheath_manip.cli.session import Session, at_least_one
from sheath_manip.seeding import scene_seed
from sheath_manip.task import SCRIPTED
from sheath_manip.types import EpisodeInfo, Purpose


@dataclass(frozen=True, kw_only=True)
class Run:
    """Let a trained policy act inside its support, and the expert outside."""

    task: TaskName
    """name of the task, as `sheath tasks` lists it"""
    checkpoint: Path
    """file of the policy and its gate, as `sheath train` and `sheath experiment` write it"""
    episodes: int = 5
    """how many"""
    seed: int = 0
    """from which the scenes follow"""
    variant: str = "default"
    """of the task"""
    store: Path | None = None
    """directory to record into; nothing is recorded without it"""
    expert: str = SCRIPTED
    """who takes over: the scripted one, or a stand-in that the task has, such as hold or back-up"""
    policy_alone: bool = False
    """without gate and expert"""
    dashboard: bool = False
    """show the run in the browser"""
    address: Address = field(default_factory=Address)

    def run(self, session: Session) -> int:
        """Run the episodes, then print what each showed."""
        at_least_one("episodes", self.episodes)
        task = session.task(self.task)
        # Only now: torch takes seconds to import.
        from sheath_manip.checkpoint import digest, load_checkpoint
        from sheath_manip.cli.episodes import opened, print_episodes, print_figures, run_all
        from sheath_manip.dataset.store import EpisodeStore
        from sheath_manip.gates.constant import AlwaysPolicy
        from sheath_manip.gates.support import SupportGate

        with opened(task, self.variant) as environment:
            spec = environment.spec
            checkpoint = load_checkpoint(self.checkpoint, spec)
            purpose = Purpose.EVALUATION if self.policy_alone else Purpose.LEARNING
            expert = None if self.policy_alone else task.make_expert(environment, self.expert)
            stand_in = "" if expert is None or self.expert == SCRIPTED else self.expert
            infos = [
                EpisodeInfo(
                    task=spec.name,
                    # Apart from the scenes of any round and any evaluation.
                    seed=scene_seed(purpose, "run", self.seed, index),
                    purpose=purpose,
                    control_rate_hz=spec.control_rate_hz,
                    # What a stand-in does is no demonstration, and must not be taken for one.
                    method="-".join(filter(None, (checkpoint.method or "run", stand_in))),
                    round=checkpoint.round,
                    index=index,
                    run_seed=self.seed,
                    checkpoint=digest(self.checkpoint),
                )
                for index in range(self.episodes)
            ]
            alone = self.policy_alone
            with (
                self.address.listeners(self.dashboard, spec, session) as listeners,
                session.progress("episodes", self.episodes) as report,
            ):
                records = list(
                    run_all(
                        environment,
                        infos,
                        AlwaysPolicy()
                        if alone
                        else SupportGate(
                            checkpoint.score,
                            checkpoint.threshold,
                            release_margin=checkpoint.release_margin,
                        ),
                        policy=checkpoint.policy,
                        expert=expert,
                        store=EpisodeStore.create(self.store) if self.store else None,
                        listeners=listeners,
                        report=report,
                    )
                )
        print_episodes(records, spec.metric, session)
        print_figures(records, session)
        return 0
