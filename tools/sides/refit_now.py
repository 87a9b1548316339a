"""One side of `tools.bench_refit`: a refit by today's code."""

import sys
import time

import numpy as np

from sheath_manip.gates import AlwaysExpert
from sheath_manip.gates.fitted import Sources
from sheath_manip.learning.checkpoint import Checkpoint
from sheath_manip.learning.fitting import fit_gate
from sheath_manip.learning.round_metrics import compute_round_metrics
from sheath_manip.policies import make_policy
from sheath_manip.protocols import TrainablePolicy
from sheath_manip.rollout.loop import rollout
from sheath_manip.tasks.table import STUDIES, TASKS
from sheath_manip.types import Episode, EpisodeInfo, Purpose
from sheath_manip.types.samples import Samples, joined, samples_from, visited_from

task, counts = TASKS[sys.argv[1]], [int(count) for count in sys.argv[2:]]
plan = STUDIES[sys.argv[1]].plans["full"]
environment = task.make()
spec = environment.spec
expert = task.expert(environment)
numbers = iter(range(10_000))


def episodes(count: int, policy: TrainablePolicy | None = None) -> list[Episode]:
    """Record `count` scenes, the same as the other side's; a policy proposes where there is one."""
    found = []
    for _ in range(count):
        info = EpisodeInfo.of(
            spec,
            variant="default",
            seed=next(numbers),
            purpose=Purpose.DEMONSTRATION,
            checkpoint="" if policy is None else "bench",
        )
        rng = np.random.default_rng(0)
        found.append(
            rollout(environment, info, AlwaysExpert(), rng=rng, policy=policy, expert=expert)
        )
    return found


def each(samples: Samples) -> list[Samples]:
    """Return the samples of each episode."""
    return [samples.take(samples.episodes == number) for number in np.unique(samples.episodes)]


demonstrations, held_out, check = (samples_from(episodes(count)) for count in counts[:3])
policy = make_policy(plan.policy.name, spec, seed=0, **plan.policy.settings).fit(demonstrations)
visits = episodes(counts[3], policy)
states = joined([demonstrations, visited_from(visits).labelled()])
calibration, fresh = each(held_out), each(check)


def refitted() -> Checkpoint:
    """Return policy and gate, the gate fitted anew."""
    fit = fit_gate(policy, states, calibration, plan.gate, sources=Sources())
    return Checkpoint(
        spec.name, plan.policy.name, policy, fit.gate, training_loss=fit.training_loss
    )


driver = refitted()
print(len(states), flush=True)
for _ in sys.stdin:
    begin = time.process_time()
    fitted = refitted()
    compute_round_metrics(visits, driver, fitted, fresh, spec.action.tolerance)
    print(time.process_time() - begin, flush=True)
