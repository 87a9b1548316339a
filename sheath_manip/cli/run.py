"""`sheath run`: a policy under its gate, with an expert or a fallback controller to take over."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from sheath_manip.cli.computing import Computing
from sheath_manip.cli.operated import PERSON, SIMULATED, Operating
from sheath_manip.cli.options import WITHOUT_PREFIX, Address, TaskName, default_is, spec_of
from sheath_manip.cli.session import Session, at_least_one
from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Listener
from sheath_manip.rollout.simulated_operator import OperatorConfig
from sheath_manip.seeding import scene_seed
from sheath_manip.task import SCRIPTED, Task
from sheath_manip.types import Episode, EpisodeInfo, Purpose, TaskSpec

if TYPE_CHECKING:
    from sheath_manip.cli.adjusting import Adjusting
    from sheath_manip.dashboard import Dashboard
    from sheath_manip.dashboard.explainer import Explainer
    from sheath_manip.dataset.store import EpisodeStore
    from sheath_manip.learning.checkpoint import Checkpoint
    from sheath_manip.rollout.asked import AskedInEpisode
    from sheath_manip.rollout.request import Driver


@dataclass(frozen=True, kw_only=True)
class Run:
    """Let a trained policy act inside its support, and the expert outside."""

    task: TaskName
    """name of the task, as `sheath tasks` lists it, or its place, `file.py:TASK`"""
    checkpoint: Path
    """file of the policy and its gate, as `sheath train` and `sheath experiment` write it"""
    episodes: int = 5
    """number of episodes"""
    seed: int = 0
    """seed from which the scenes follow"""
    variant: str = "default"
    """variant of the task"""
    store: Annotated[Path | None, default_is("nothing is recorded")] = None
    """directory to record into"""
    training_store: Annotated[Path | None, default_is("no support is shown")] = None
    """directory of the episodes that the checkpoint was trained on, for a person: shows the
    support on the page, and lets ν be changed there, not only the threshold"""
    expert: str = SCRIPTED
    """expert that takes over: the scripted one, a fallback controller that the task has, such as
    hold or back-up, a person, who is asked on the page and may take over there at any time, or a
    simulated-person in that place, who reacts late"""
    robots: int = 1
    """number of robots, each in a process of its own, which one person serves one after another"""
    policy_alone: bool = False
    """let the policy act without gate and expert"""
    dashboard: bool = False
    """show the run in the browser"""
    simulated: OperatorConfig = field(default_factory=OperatorConfig)
    """the simulated person"""
    operating: Annotated[Operating, WITHOUT_PREFIX] = field(default_factory=Operating)
    computing: Annotated[Computing, WITHOUT_PREFIX] = field(default_factory=Computing)
    address: Annotated[Address, WITHOUT_PREFIX] = field(default_factory=Address)

    def run(self, session: Session) -> int:
        """Run the episodes, then print what each showed."""
        self.computing.begin()
        at_least_one("episodes", self.episodes)
        if at_least_one("robots", self.robots) > self.episodes:
            raise ParameterError(
                f"robots is {self.robots}, and episodes {self.episodes}; wanted at least one "
                f"episode for each, such as --episodes {self.robots}"
            )
        task = session.runnable(self.task)
        if self.expert == PERSON:
            return self._with_a_person(task, session)
        if self.robots > 1:
            raise ParameterError(
                f"--robots {self.robots} is for a person; wanted --expert {PERSON}, or without one "
                f"`sheath evaluate --workers {self.robots}`"
            )
        if self.expert == SIMULATED and self.policy_alone:
            raise ParameterError("a policy alone has no expert; wanted --policy-alone or a person")
        if self.expert != SIMULATED:
            self.operating.require_default()
            if self.simulated != OperatorConfig():
                raise ParameterError(f"--simulated is for one; wanted --expert {SIMULATED}")
        if self.training_store is not None:
            raise ParameterError(f"--training-store is for a person; wanted --expert {PERSON}")
        # Only now: torch takes seconds to import.
        from sheath_manip.learning.checkpoint import digest
        from sheath_manip.learning.drivers import GatedPolicy, PolicyAlone

        checkpoint, named = self._checkpoint(task, session), digest(self.checkpoint)
        driver: Driver = PolicyAlone(self.checkpoint, named)
        if not self.policy_alone:
            # A gate that judges by nothing is no gate: said before anything runs.
            checkpoint.gate()
            driver = GatedPolicy(self.checkpoint, named, self._beneath)
        if self.expert == SIMULATED:
            driver = self.operating.answered(driver, self.simulated)
        else:
            driver = self.operating.timed(driver, paced=False)
        explainer = self._explainer(task) if self.dashboard else None
        spec = spec_of(task)
        with self.address.listeners(self.dashboard, spec, session, explainer) as listeners:
            for page in listeners:
                page.saved_in = self._saved_in
            return self._run(task, session, checkpoint, driver, listeners)

    def _with_a_person(self, task: Task, session: Session) -> int:
        if self.policy_alone:
            raise ParameterError("a policy alone has no expert; wanted --policy-alone or a person")
        from sheath_manip.cli.adjusting import adjusted, scenes_of
        from sheath_manip.cockpit.start import UntilReady

        checkpoint = self._checkpoint(task, session)
        with session.err.status("reading"):
            adjusting = adjusted(
                self.checkpoint, checkpoint, self.training_store, spec_of(task), scenes_of(task)
            )
        explainer = adjusting.explainer
        if self.robots > 1:
            return self._fleet(task, session, checkpoint, adjusting)
        with self.operating.crew(task, self.address, session, adjusting.widgets, explainer) as crew:
            if adjusting.states is not None:
                crew.page.on_fit(adjusting.states)
            crew.page.saved_in = self._saved_in
            driver = crew.driver(adjusting.driver)
            page, *others = crew.listeners
            listeners = (page, UntilReady(crew.cockpit), *others)
            return self._run(crew.operated(), session, checkpoint, driver, listeners)

    def _fleet(
        self, task: Task, session: Session, checkpoint: "Checkpoint", adjusting: "Adjusting"
    ) -> int:
        from sheath_manip.cli.fleet import run_fleet
        from sheath_manip.learning.checkpoint import digest
        from sheath_manip.learning.drivers import GatedPolicy
        from sheath_manip.rollout.request import EpisodeRequest

        store, infos = self._asked_for(spec_of(task), checkpoint)
        # A value: each robot reads its own, so no slider here could move them.
        driver = GatedPolicy(self.checkpoint, digest(self.checkpoint))

        def prepare(page: "Dashboard") -> None:
            if adjusting.states is not None:
                page.on_fit(adjusting.states)
            page.saved_in = self._saved_in

        return run_fleet(
            self.robots,
            task,
            self.operating,
            self.address,
            session,
            adjusting.explainer,
            [EpisodeRequest(task, info, driver) for info in infos],
            store,
            prepare,
        )

    def _explainer(self, task: Task) -> "Explainer":
        from sheath_manip.cli.adjusting import scenes_of
        from sheath_manip.dashboard.explainer import Explainer
        from sheath_manip.dashboard.reference import GateReference

        spec = spec_of(task)
        return Explainer(
            spec, lambda: GateReference.load(self.checkpoint, spec, None), scenes_of(task)
        )

    @property
    def _beneath(self) -> str:
        """The expert of the driver beside which a person sits."""
        return SCRIPTED if self.expert == SIMULATED else self.expert

    @property
    def _saved_in(self) -> str:
        return "" if self.store is None else str(self.store)

    def _checkpoint(self, task: Task, session: Session) -> "Checkpoint":
        from sheath_manip.cli.episodes import opened
        from sheath_manip.learning.checkpoint import load_checkpoint

        with opened(task, self.variant) as probe:
            checkpoint = load_checkpoint(self.checkpoint, probe.spec)
        session.remark(checkpoint.remark)
        return checkpoint

    def _asked_for(
        self, spec: TaskSpec, checkpoint: "Checkpoint"
    ) -> "tuple[EpisodeStore | None, list[EpisodeInfo]]":
        """The store, if any, and the episodes."""
        from sheath_manip.dataset.sessions import begun, new_session
        from sheath_manip.dataset.store import EpisodeStore
        from sheath_manip.learning.checkpoint import digest

        purpose = Purpose.EVALUATION if self.policy_alone else Purpose.LEARNING
        named = digest(self.checkpoint)
        fallback = "" if self.policy_alone or self.expert == SCRIPTED else self.expert
        infos = [
            EpisodeInfo.of(
                spec,
                variant=self.variant,
                # Apart from the scenes of any round and any evaluation.
                seed=scene_seed(purpose, "run", self.seed, index),
                purpose=purpose,
                # What a fallback does is no demonstration, and must not be taken for one.
                method="-".join(filter(None, (checkpoint.method or "run", fallback))),
                round=checkpoint.round,
                index=index,
                run_seed=self.seed,
                checkpoint=named,
            )
            for index in range(self.episodes)
        ]
        store = EpisodeStore.create(self.store) if self.store else None
        if store is not None and self.expert == PERSON:
            # The same scene by hand again is another episode.
            infos = begun(store, infos, new_session())
        return store, infos

    def _run(
        self,
        task: Task,
        session: Session,
        checkpoint: "Checkpoint",
        driver: "Driver",
        listeners: Sequence[Listener],
    ) -> int:
        from sheath_manip.cli.asked import print_asked
        from sheath_manip.cli.episodes import print_episodes, print_figures, run_all
        from sheath_manip.rollout.asked import asked_in
        from sheath_manip.rollout.request import EpisodeRequest
        from sheath_manip.rollout.serial import SerialExecutor

        spec = spec_of(task)
        store, infos = self._asked_for(spec, checkpoint)
        requests = [EpisodeRequest(task, info, driver) for info in infos]
        asked: list[AskedInEpisode] = []

        def count(episode: Episode) -> None:
            asked.append(asked_in(episode))

        with SerialExecutor() as executor, session.progress("episodes", self.episodes) as report:
            records = list(run_all(executor, requests, store, listeners, report, count))
        print_episodes(records, spec.metric, session)
        print_figures(records, session)
        print_asked(asked, session)
        return 0
