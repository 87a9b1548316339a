"""One side of `tools.bench_refit`: a refit by the code of 6b34bec, which alone can import this."""

import sys
import time
from dataclasses import replace

import numpy as np
from sheath_manip.dataset.samples import joined, samples_from, visited_from
from sheath_manip.fitting import fit_gate
from sheath_manip.measuring import measures_of

from sheath_manip.gates import AlwaysExpert
from sheath_manip.policies import make_policy
from sheath_manip.rollout import rollout
from sheath_manip.types import EpisodeInfo, Purpose
from tasks.table import TASKS

task, counts = TASKS[sys.argv[1]], [int(count) for count in sys.argv[2:]]
plan = task.plans["full"]
environment = task.make()
spec = environment.spec
expert = task.expert(environment)
numbers = iter(range(10_000))


def episodes(count, policy=None):
    """Record `count` scenes; a policy proposes where there is one."""
    infos = [
        EpisodeInfo(spec.name, next(numbers), Purpose.DEMONSTRATION, spec.control_rate_hz)
        for _ in range(count)
    ]
    rng = np.random.default_rng(0)
    gate = AlwaysExpert()
    return [
        rollout(environment, info, gate, rng=rng, policy=policy, expert=expert) for info in infos
    ]


demonstrations, held_out, check = (samples_from(episodes(count)) for count in counts[:3])
policy = make_policy(plan.policy, spec, seed=0, **plan.policy_settings).fit(demonstrations)
visits = episodes(counts[3], policy)
visited = visited_from(visits)
states = joined([demonstrations, visited.labelled()])


def each(samples):
    """Return the samples of each episode."""
    return [samples.take(samples.episodes == number) for number in np.unique(samples.episodes)]


held_out, check = each(held_out), each(check)
driver = fit_gate(policy, states, held_out, plan, spec.name)
print(len(states), flush=True)
for _ in sys.stdin:
    begin = time.process_time()
    fitted = fit_gate(policy, states, held_out, plan, spec.name)
    measures_of(visits, visited, replace(driver), fitted, states, check, spec.action.tolerance)
    print(time.process_time() - begin, flush=True)
