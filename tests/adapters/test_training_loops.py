"""Training loops of others: a thousand steps on a task, and on one with a gate around it."""

import gymnasium
import numpy as np
import pytest
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from torch import nn

from sheath_manip.adapters.gated_env import GatedEnv
from sheath_manip.adapters.to_gymnasium import to_gymnasium
from tests.adapters.corridor_gate import checkpoint
from tests.guest_package.guest.slide import SLIDE
from tests.toy import CORRIDOR

STEPS = 1000


def measured(env: gymnasium.Env) -> gymnasium.Env:
    """What is measured alone, which a small network learns from."""
    space = env.observation_space
    assert isinstance(space, gymnasium.spaces.Dict)
    return gymnasium.wrappers.TransformObservation(
        env, lambda seen: seen["features"], space["features"]
    )


class Infos(BaseCallback):
    """Keeps what was said of each step."""

    def _init_callback(self):
        self.told = []

    def _on_step(self):
        self.told += self.locals["infos"]
        return True


def taught_by_stable_baselines(env: gymnasium.Env) -> list[dict]:
    infos = Infos()
    PPO("MlpPolicy", env, n_steps=250, batch_size=50, n_epochs=2, device="cpu").learn(STEPS, infos)
    return infos.told


@pytest.mark.parametrize("task", ["platformer", "slide"])
def test_stable_baselines_learns_on_a_task(task):
    env = to_gymnasium(SLIDE) if task == "slide" else gymnasium.make(f"sheath/{task}-v0")
    told = taught_by_stable_baselines(env)
    assert len(told) == STEPS
    ended = [each for each in told if "episode" in each]
    assert ended
    # What its monitor counts as success.
    assert all(each["is_success"] is (each["outcome"] == "success") for each in ended)


def test_stable_baselines_learns_under_a_gate():
    told = taught_by_stable_baselines(measured(GatedEnv(to_gymnasium(CORRIDOR), checkpoint())))
    assert len(told) == STEPS
    assert {each["actor"] for each in told} == {"policy", "expert"}
    assert all(each["executed"] == each["proposed"] for each in told if each["actor"] == "policy")
    assert all(each["executed"] == each["labelled"] for each in told if each["actor"] == "expert")


def test_a_loop_in_plain_torch_learns_from_the_labels_of_a_gate():
    """DAgger in twenty lines: the learner is taught by what the expert says where it is asked."""
    torch.manual_seed(0)
    env = measured(GatedEnv(to_gymnasium(CORRIDOR), checkpoint()))
    net = nn.Sequential(nn.Linear(2, 32), nn.ReLU(), nn.Linear(32, 3))
    adam = torch.optim.Adam(net.parameters(), 1e-2)
    states, labels, losses, actors = [], [], [], set()
    seen, _ = env.reset(seed=0)
    for step in range(STEPS):
        choice = int(net(torch.from_numpy(seen)).argmax())
        after, _, terminated, truncated, info = env.step(choice)
        actors.add(info["actor"])
        if info["labelled"] is not None:
            states.append(seen)
            labels.append(info["labelled"])
        if step % 10 == 9:
            loss = nn.functional.cross_entropy(
                net(torch.from_numpy(np.stack(states))), torch.tensor(labels)
            )
            adam.zero_grad()
            loss.backward()
            adam.step()
            losses.append(loss.item())
        seen = env.reset()[0] if terminated or truncated else after
    assert losses[-1] < 0.6 < losses[0]
    assert actors == {"policy", "expert"}
