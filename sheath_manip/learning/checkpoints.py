"""The checkpoints of one training run: each read where it lies, or fitted and saved now."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from sheath_manip.gates.fitted import FittedGate, Sources
from sheath_manip.gates.making import GATES
from sheath_manip.learning.checkpoint import Checkpoint, digest, load_checkpoint
from sheath_manip.learning.config import LearningPlan
from sheath_manip.learning.fitting import fit_gate, recalibrated
from sheath_manip.learning.keeping import keep
from sheath_manip.learning.methods import Method
from sheath_manip.learning.results import EXPERT, round_path
from sheath_manip.policies import make_policy
from sheath_manip.policies.agreement import held_out_agreement
from sheath_manip.policies.looking import look
from sheath_manip.protocols import TrainablePolicy
from sheath_manip.seeding import seed_for
from sheath_manip.types import TaskSpec
from sheath_manip.types.samples import Samples

NOTHING: Mapping[str, Any] = {}


class Checkpoints:
    """Fits policy and gate of each round of each method once and for all."""

    def __init__(
        self,
        spec: TaskSpec,
        plan: LearningPlan,
        run_seed: int,
        runs: Path,
        held_out: Sequence[str],
        calibration: Sequence[Samples],
    ) -> None:
        """Store what all rounds share.

        Args:
            spec: of the task.
            plan: of the experiment; each method changes it in its own way.
            run_seed: of the training run.
            runs: where checkpoints lie.
            held_out: names of the expert episodes for thresholds.
            calibration: these episodes.
        """
        self.spec = spec
        self.plan = plan
        self.run_seed = run_seed
        self.runs = runs
        self.held_out = tuple(held_out)
        self.calibration = calibration

    def first(self, states: Samples, names: Sequence[str]) -> Checkpoint:
        """Return the one that all methods start from, fitted to the demonstrations of `names`."""

        def fit() -> Checkpoint:
            policy = self._fresh_policy(self.plan).fit(states)
            return self._with_gate(self.plan.for_round(1), policy, states, names)

        return self._read_or(fit, EXPERT, 0)

    def begun(
        self,
        method: Method,
        first: Checkpoint,
        states: Samples,
        names: Sequence[str],
        given: Mapping[str, Any] = NOTHING,
    ) -> Checkpoint:
        """Return `first` with the method's own gate, and its policy as the method begins with it.

        Where the method looks as the plan does, and only holds or labels otherwise, nothing has to
        be fitted for that. `given` are the gate's settings in round 1 that a schedule or another
        method says.
        """
        shared, plan = self.plan.for_round(1), self._plan_of(method, 1, given)
        if plan == shared:
            return first

        def fit() -> Checkpoint:
            policy = first.policy
            if plan.policy != self.plan.policy:
                learned = method.initial_policy(first.policy.arrays())
                policy = self._fresh_policy(plan).load(learned)
            config = plan.gate
            if not GATES[config.kind].looks:
                # Without the threshold of the gate that all others begin with.
                fitted = FittedGate(config, policy, sources=first.fitted.sources)
                return replace(first, policy=policy, policy_name=plan.policy.name, fitted=fitted)
            if first.fitted.signal is not None and config.fitted_like(shared.gate):
                return replace(first, fitted=replace(first.fitted, config=config))
            return self._with_gate(plan, policy, states, names)

        return self._read_or(fit, method.name, 0)

    def refitted(
        self,
        method: Method,
        number: int,
        previous: Checkpoint,
        aggregated: Samples,
        visited: Samples,
        names: Sequence[str],
        given: Mapping[str, Any] = NOTHING,
    ) -> Checkpoint:
        """Return that after round `number`: policy (warm), signal and threshold.

        Args:
            method: whose round it was.
            number: of the round, from 1.
            previous: drove the round.
            aggregated: all labelled states so far.
            visited: all states of the round. Where none was labelled, nothing new is known of the
                policy, and only the threshold is found again.
            names: of the episodes that `aggregated` is from.
            given: the gate's settings in the next round that a schedule or another method says.
        """
        plan = self._plan_of(method, number + 1, given)
        new = visited.labelled()

        def fit() -> Checkpoint:
            if len(new) == 0:
                kept = replace(previous.fitted, config=plan.gate)
                if kept.signal is not None and plan.gate.threshold.recalibrate:
                    kept = recalibrated(kept, self.calibration, visited)
                return replace(previous, fitted=kept)
            # A copy: what drove the round is yet to be measured.
            policy = self._fresh_policy(plan).load(previous.policy.arrays())
            policy.fit(new if method.latest_only else aggregated)
            return self._with_gate(plan, policy, aggregated, names, previous.fitted, visited)

        return self._read_or(fit, method.name, number)

    def path(self, checkpoint: Checkpoint) -> Path:
        """Return where the file of a checkpoint lies."""
        return self._path(checkpoint.method, checkpoint.round)

    def digest(self, checkpoint: Checkpoint) -> str:
        """Return the digest of the checkpoint's file."""
        return digest(self.path(checkpoint))

    def _plan_of(self, method: Method, number: int, given: Mapping[str, Any]) -> LearningPlan:
        """What the method makes of the plan of a round, with what that round gives it."""
        plan = method.plan(self.plan.for_round(number))
        return plan.changed(gate=given) if given else plan

    def _with_gate(
        self,
        plan: LearningPlan,
        policy: TrainablePolicy,
        states: Samples,
        names: Sequence[str],
        previous: FittedGate | None = None,
        visited: Samples | None = None,
    ) -> Checkpoint:
        sources = Sources(tuple(names), self.held_out)
        if GATES[plan.gate.kind].looks:
            fit = fit_gate(
                policy,
                states,
                self.calibration,
                plan.gate,
                sources=sources,
                agreement=partial(
                    held_out_agreement,
                    partial(self._fresh_policy, plan),
                    states,
                    tolerance=self.spec.action.tolerance,
                ),
                previous=previous,
                visited=visited,
            )
            fitted, loss = fit.gate, fit.training_loss
        else:
            fitted = FittedGate(plan.gate, policy, sources=sources)
            losses = look(policy, states).losses
            assert losses is not None
            loss = float(np.mean(losses))
        return Checkpoint(self.spec.name, plan.policy.name, policy, fitted, training_loss=loss)

    def _fresh_policy(self, plan: LearningPlan) -> TrainablePolicy:
        seed = seed_for("policy", self.run_seed)
        return make_policy(plan.policy.name, self.spec, seed, **plan.policy.settings)

    def _read_or(self, fit: Callable[[], Checkpoint], method: str, number: int) -> Checkpoint:
        path = self._path(method, number)
        if not path.exists():
            fitted = replace(fit(), method=method, round=number, run_seed=self.run_seed)
            keep(fitted, path)
        # Read back, so that a resumed run continues from the same bits as an uninterrupted one.
        return load_checkpoint(path, self.spec)

    def _path(self, method: str, number: int) -> Path:
        return round_path(self.runs, self.run_seed, method, number, "npz")
