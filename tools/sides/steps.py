"""One side of `tools.bench_guard`: runs the steps of an episode whenever it is told to.

It runs in a checkout of any version, so it asks for no more than all of them have: the loop, the
tasks' table, an expert, a policy that looks at every pixel, and a support gate.
"""

import sys
import time
from dataclasses import replace
from itertools import count

import numpy as np

from sheath_manip.gates import SupportGate
from sheath_manip.rollout.loop import rollout
from sheath_manip.rollout.threads import single_threaded
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import EpisodeInfo, Judgement, Proposal, Purpose

STEPS = 120
"""of an episode, after which the next one is begun"""


class Short:
    """Another environment, whose episodes end soon."""

    def __init__(self, environment):
        self.environment = environment
        self.spec = environment.spec
        self.state = environment.state
        self.outcome = environment.outcome
        self.metrics = environment.metrics

    def reset(self, seed):
        """Start the episode."""
        self.left = STEPS
        return self.environment.reset(seed)

    def step(self, action):
        """Run one control step."""
        self.left -= 1
        made = self.environment.step(action)
        return made if self.left else replace(made, truncated=True)


class Echo:
    """Proposes what the expert does, and shows what it saw to the gate."""

    def __init__(self, expert):
        self.expert = expert

    def reset(self, rng):
        """Begin an episode."""
        del rng

    def follow(self, observation):
        """Look at the state."""
        self.present = observation

    def propose(self, observations):
        """Ask the expert."""
        seen = [image.astype(np.float32).mean((1, 2)) for image in observations.images.values()]
        latents = np.concatenate([*seen, observations.features], axis=1)
        return Proposal(np.asarray(self.expert.act(self.present))[None], {"seen": latents})


class Certain:
    """Judges all as inside."""

    def judge(self, observation, proposal, threshold):
        """Look at all of the latents."""
        del observation, threshold
        return Judgement(float(np.isfinite(proposal.latents["seen"]).all()))


def main() -> None:
    """Answer each line with CPU seconds a step."""
    task = TASKS[sys.argv[1]]
    environment = task.make()
    expert = task.make_expert(environment)
    spec, short = environment.spec, Short(environment)
    with single_threaded():
        print("ready", flush=True)
        for seed in count():
            if not sys.stdin.readline():
                return
            info = EpisodeInfo(spec.name, seed, Purpose.LEARNING, spec.control_rate_hz)
            gate = SupportGate(Certain(), 0.5, query=False)
            begin = time.process_time()
            rng = np.random.default_rng(seed)
            episode = rollout(short, info, gate, rng=rng, policy=Echo(expert), expert=expert)
            print((time.process_time() - begin) / len(episode), len(episode), flush=True)


if __name__ == "__main__":
    main()
