"""One side of `tools.bench_guard`: runs control steps whenever it is told to.

It runs in a checkout of any version, so it asks for no more than all of them have: the loop, the
tasks' table, an expert, and a support gate.
"""

import sys
import time
from dataclasses import replace

import numpy as np

from sheath_manip.gates import SupportGate
from sheath_manip.rollout.loop import rollout
from sheath_manip.rollout.threads import single_threaded
from sheath_manip.tasks.table import TASKS
from sheath_manip.types import EpisodeInfo, Judgement, Proposal, Purpose, Transition

STEPS = 120
"""of an episode"""
WHOLE = 3
"""times that it is simulated"""
REPEATS = 20
"""of the episode as it was recorded, in a turn"""


class Short:
    """Another environment, whose episode ends soon, and is remembered."""

    def __init__(self, environment):
        self.environment = environment
        self.spec = environment.spec
        self.outcome = environment.outcome
        self.metrics = environment.metrics
        self.states, self.transitions = [], []

    def reset(self, seed):
        """Start the episode."""
        self.first = self.environment.reset(seed)
        return self.first

    def state(self):
        """Look at the state."""
        self.states.append(self.environment.state())
        return self.states[-1]

    def step(self, action):
        """Run one control step."""
        made = self.environment.step(action)
        if len(self.transitions) + 1 >= STEPS:
            made = replace(made, truncated=True)
        self.transitions.append(made)
        return made


class Remembered:
    """The episode of another environment once more: nothing is simulated or drawn."""

    def __init__(self, short):
        self.short = short
        self.spec = short.spec
        self.ended, self.figures = short.outcome(), short.metrics()

    def reset(self, seed):
        """Start it."""
        del seed
        self.place = 0
        return self.short.first

    def state(self):
        """Return the state of that step."""
        return self.short.states[self.place]

    def step(self, action) -> Transition:
        """Return what was answered."""
        del action
        self.place += 1
        return self.short.transitions[self.place - 1]

    def outcome(self):
        """Return how it ended."""
        return self.ended

    def metrics(self):
        """Return its figures."""
        return self.figures


class Echo:
    """Proposes what the expert does, with latents as small networks have them."""

    def __init__(self, expert, actions):
        self.expert, self.actions = expert, actions
        self.latents = {"penultimate": np.ones((1, 64), np.float32)}

    def reset(self, rng):
        """Begin an episode."""
        del rng
        self.place = 0

    def follow(self, observation):
        """Look at the state."""
        self.present = observation

    def propose(self, observations):
        """Ask the expert, or remember what it said."""
        del observations
        if self.place == len(self.actions):
            self.actions.append(np.array(self.expert.act(self.present), np.float32))
        self.place += 1
        return Proposal(self.actions[self.place - 1][None], self.latents)


class Certain:
    """Judges all as inside."""

    def judge(self, observation, proposal, threshold):
        """Look at nothing."""
        del observation, proposal, threshold
        return Judgement(1.0)


def main() -> None:
    """Print CPU seconds of a step, then for each line that comes those of the loop in it."""
    task = TASKS[sys.argv[1]]
    environment = task.make()
    expert = task.make_expert(environment)
    spec = environment.spec
    info = EpisodeInfo(spec.name, 0, Purpose.LEARNING, spec.control_rate_hz)

    def step_s(place, policy, repeats):
        gate = SupportGate(Certain(), 0.5, query=False)
        begin, steps = time.process_time(), 0
        for _ in range(repeats):
            rng = np.random.default_rng(0)
            steps += len(rollout(place, info, gate, rng=rng, policy=policy, expert=expert))
        return (time.process_time() - begin) / steps

    with single_threaded():
        runs = [(Short(environment), Echo(expert, [])) for _ in range(WHOLE)]
        took = [step_s(*run, 1) for run in runs]
        short, policy = runs[-1]
        # The first one warms up.
        print(min(took), flush=True)
        remembered = Remembered(short)
        while sys.stdin.readline():
            print(step_s(remembered, policy, REPEATS), flush=True)


if __name__ == "__main__":
    main()
