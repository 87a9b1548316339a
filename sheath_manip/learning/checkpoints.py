"""The checkpoints of one training run: each read where it lies, or fitted and saved now."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from sheath_manip.learning.checkpoint import Checkpoint, digest, load_checkpoint, with_policy
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.fitting import calibrated, fit_gate
from sheath_manip.learning.methods import Method
from sheath_manip.learning.results import EXPERT, round_path
from sheath_manip.policies import make_policy
from sheath_manip.policies.agreement import held_out_agreement
from sheath_manip.protocols import Policy
from sheath_manip.seeding import seed_for
from sheath_manip.types import TaskSpec
from sheath_manip.types.samples import Samples


class Checkpoints:
    """Fits policy and gate of each round of each method once and for all."""

    def __init__(self, spec: TaskSpec, plan: LearningPlan, run_seed: int, runs: Path) -> None:
        self.spec = spec
        self.plan = plan
        self.run_seed = run_seed
        self.runs = runs

    def first(self, states: Samples, calibration: Sequence[Samples]) -> Checkpoint:
        """The one that all methods start from, fitted to the demonstrations."""

        def fit() -> Checkpoint:
            policy = self._fresh_policy(self.plan).fit(states)
            return self._with_gate(self.plan, policy, states, calibration)

        return self._read_or(fit, EXPERT, 0)

    def begun(
        self,
        method: Method,
        first: Checkpoint,
        states: Samples,
        calibration: Sequence[Samples],
    ) -> Checkpoint:
        """`first` as it is, or its policy under the method's own gate where it has another."""
        plan = method.plan(self.plan)
        # Which states get labels is nothing that a checkpoint is fitted to.
        if plan.changed(gate={"labels": self.plan.gate.labels}) == self.plan:
            return first

        def fit() -> Checkpoint:
            policy = self._fresh_policy(plan).load(method.begin(first.policy.arrays()))
            return self._with_gate(plan, policy, states, calibration)

        return self._read_or(fit, method.name, 0)

    def refitted(
        self,
        method: Method,
        number: int,
        previous: Checkpoint,
        aggregated: Samples,
        visited: Samples,
        calibration: Sequence[Samples],
    ) -> Checkpoint:
        """After round `number`: policy (warm), signal and threshold.

        Args:
            method: whose round it was.
            number: of the round, from 1.
            previous: drove the round.
            aggregated: all labelled states so far.
            visited: all states of the round. Where none was labelled, nothing new is known of the
                policy, and only the threshold is found again.
            calibration: held-out expert episodes.
        """
        plan = method.plan(self.plan)
        new = visited.labelled()

        def fit() -> Checkpoint:
            if len(new) == 0:
                again = plan.gate.threshold.recalibrate
                return calibrated(previous, calibration, plan.gate, visited) if again else previous
            # A copy: what drove the round is yet to be measured.
            policy = self._fresh_policy(plan).load(previous.policy.arrays())
            policy.fit(new if method.latest_only else aggregated)
            if not (method.looks or plan.schedule.refit_unused):
                return with_policy(previous, policy)
            return self._with_gate(plan, policy, aggregated, calibration, previous, visited)

        return self._read_or(fit, method.name, number)

    def digest(self, checkpoint: Checkpoint) -> str:
        """Of the checkpoint's file."""
        return digest(self._path(checkpoint.method, checkpoint.round))

    def _with_gate(
        self,
        plan: LearningPlan,
        policy: Policy,
        states: Samples,
        calibration: Sequence[Samples],
        previous: Checkpoint | None = None,
        visited: Samples | None = None,
    ) -> Checkpoint:
        return fit_gate(
            policy,
            states,
            calibration,
            plan.gate,
            self.spec.name,
            policy_name=plan.policy.name,
            agreement=partial(
                held_out_agreement,
                partial(self._fresh_policy, plan),
                states,
                tolerance=self.spec.action.tolerance,
            ),
            previous=previous,
            visited=visited,
        )

    def _fresh_policy(self, plan: LearningPlan) -> Policy:
        seed = seed_for("policy", self.run_seed)
        return make_policy(plan.policy.name, self.spec, seed, **plan.policy.settings)

    def _read_or(self, fit: Callable[[], Checkpoint], method: str, number: int) -> Checkpoint:
        path = self._path(method, number)
        if not path.exists():
            fitted = replace(fit(), method=method, round=number, run_seed=self.run_seed)
            fitted.save(path)
        # Read back, so that a resumed run continues from the same bits as an uninterrupted one.
        return load_checkpoint(path, self.spec)

    def _path(self, method: str, number: int) -> Path:
        return round_path(self.runs, self.run_seed, method, number, "npz")
