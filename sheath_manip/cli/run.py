"""`sheath run`: a policy under its gate, with an expert or a stand-in to take over."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from sheath_manip.cli.operated import PERSON, Operating
from sheath_manip.cli.options import WITHOUT_PREFIX, Address, TaskName
from sheath_manip.cli.session import Session, at_least_one
from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Environment, Gate, Listener
from sheath_manip.seeding import scene_seed
from sheath_manip.task import SCRIPTED, Task
from sheath_manip.types import EpisodeInfo, Purpose

if TYPE_CHECKING:
    from sheath_manip.learning.checkpoint import Checkpoint


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
    trained_on: Path | None = None
    """directory of the episodes that the checkpoint was trained on, for a person: shows the
    support on the page, and lets ν be changed there, not only the threshold"""
    expert: str = SCRIPTED
    """who takes over: the scripted one, a stand-in that the task has, such as hold or back-up, or a
    person, who is asked on the page and may take over there at any time"""
    policy_alone: bool = False
    """without gate and expert"""
    dashboard: bool = False
    """show the run in the browser"""
    operating: Annotated[Operating, WITHOUT_PREFIX] = field(default_factory=Operating)
    address: Annotated[Address, WITHOUT_PREFIX] = field(default_factory=Address)

    def run(self, session: Session) -> int:
        """Run the episodes, then print what each showed."""
        at_least_one("episodes", self.episodes)
        task = session.task(self.task)
        if self.expert == PERSON:
            return self._with_a_person(task, session)
        self.operating.require_default()
        if self.trained_on is not None:
            raise ParameterError(f"--trained-on is for a person; wanted --expert {PERSON}")
        # Only now: torch takes seconds to import.
        from sheath_manip.cli.adjusting import support_gate
        from sheath_manip.cli.episodes import opened
        from sheath_manip.gates.constant import AlwaysPolicy
        from sheath_manip.learning.checkpoint import load_checkpoint

        with opened(task, self.variant) as environment:
            checkpoint = load_checkpoint(self.checkpoint, environment.spec)
            gate = AlwaysPolicy() if self.policy_alone else support_gate(checkpoint)
            with self.address.listeners(self.dashboard, environment.spec, session) as listeners:
                return self._run(task, session, environment, checkpoint, gate, listeners)

    def _with_a_person(self, task: Task, session: Session) -> int:
        if self.policy_alone:
            raise ParameterError("a policy alone has no expert; wanted --policy-alone or a person")
        from sheath_manip.cli.adjusting import adjusted
        from sheath_manip.cli.episodes import opened
        from sheath_manip.learning.checkpoint import load_checkpoint

        with opened(task, self.variant) as probe:
            checkpoint = load_checkpoint(self.checkpoint, probe.spec)
        with session.err.status("reading"):
            adjusting = adjusted(checkpoint, self.trained_on)
        with (
            self.operating.crew(task, self.address, session, adjusting.parts) as crew,
            opened(operated := crew.operated(), self.variant) as environment,
        ):
            if adjusting.states is not None:
                crew.page.on_fit(adjusting.states)
            gate = crew.gate(adjusting.gate)
            return self._run(operated, session, environment, checkpoint, gate, crew.listeners)

    def _run(
        self,
        task: Task,
        session: Session,
        environment: Environment,
        checkpoint: "Checkpoint",
        gate: Gate,
        listeners: Sequence[Listener],
    ) -> int:
        from sheath_manip.cli.episodes import print_episodes, print_figures, run_all
        from sheath_manip.dataset.store import EpisodeStore
        from sheath_manip.learning.checkpoint import digest

        spec, alone = environment.spec, self.policy_alone
        purpose = Purpose.EVALUATION if alone else Purpose.LEARNING
        name = SCRIPTED if self.expert == PERSON else self.expert
        expert = None if alone else task.make_expert(environment, name)
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
        with session.progress("episodes", self.episodes) as report:
            records = list(
                run_all(
                    environment,
                    infos,
                    gate,
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
