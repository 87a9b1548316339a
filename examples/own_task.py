"""A task of one's own in one file, without a simulator: checked, then driven by its expert.

python examples/own_task.py [own_task.png]
sheath collect examples/own_task.py:CART --store runs/carts
"""

import sys

import numpy as np
from PIL import Image

import sheath_manip as sheath
from sheath_manip.testing import check_task

PUSH = sheath.ActionSpec(("push",), np.array([-1], np.float32), np.array([1], np.float32))


class Cart(sheath.ArrayEnvironment):
    spec = sheath.TaskSpec("cart", 10.0, PUSH, {}, ("offset_m",), max_steps=60, metric="offset_m")

    def reset(self, seed):
        return self.restore([np.random.default_rng(seed).uniform(-2, -1), 0])

    def observe(self):
        return sheath.Observation({}, self.at[:1].astype(np.float32), self.at[1] / 10)

    def step(self, action):
        seen = self.restore(self.at + np.array([0.1 * PUSH.validated(action)[0], 1]))
        done = self.outcome() is sheath.Outcome.SUCCESS
        return sheath.Transition(seen, 0.0, done, not done and self.at[1] >= self.spec.max_steps)

    def outcome(self):
        return sheath.Outcome.SUCCESS if abs(self.at[0]) < 0.05 else sheath.Outcome.TIME_LIMIT

    def metrics(self):
        return {"offset_m": abs(float(self.at[0]))}


class Pusher(sheath.Expert):
    def __init__(self, cart):
        self.cart = cart

    def act(self, observation):
        return np.clip(-4 * observation.features, -1, 1)


def picture(cart):
    image, x = np.full((160, 640, 3), 245, np.uint8), int(320 + 140 * cart.at[0])
    image[80:110, x - 24 : x + 24] = image[110:, 318:322] = (0, 84, 147)
    return image


CART = sheath.Task("cart", "push a cart to a mark", {"default": Cart}, Pusher, picture=picture)

if __name__ == "__main__":
    check_task(CART)
    (episode,), path = sheath.demonstrations(CART, 1), (*sys.argv, "own_task.png")[1]
    Image.fromarray(sheath.contact_sheet(CART, episode, (0, -6, -1))).save(path)
    print(f"{episode.outcome} after {len(episode)} steps, drawn in {path}")
