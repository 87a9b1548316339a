"""Gate a plain torch policy: a network of one's own, judged by what its layers show.

    python examples/gate_a_torch_policy.py [gate_a_torch_policy.png [STEPS OF TRAINING]]

`from_torch` hands out the hidden layer, for the support, and the scores of the choices, for trust.
The network looks once a step. In the picture: start, a takeover, end.
"""

import sys

import numpy as np
import torch
from PIL import Image

import sheath_manip as sheath
from sheath_manip.tasks.table import TASKS

GATE = sheath.GateConfig(signal="trust-joined", embedding="latent", precedent_embedding="features")

task = TASKS["platformer"]
path, steps = sys.argv[1:] + ["gate_a_torch_policy.png", "300"][len(sys.argv) - 1 :]
shown = sheath.demonstrations(task, 6, "one-stage")
states, held_out = sheath.samples_from(shown[:3]), [sheath.samples_from([e]) for e in shown[3:]]
action = task.make("one-stage").spec.action
torch.manual_seed(0)
layers = torch.nn.Linear(states.features.shape[1], 64), torch.nn.ReLU()
network = torch.nn.Sequential(*layers, torch.nn.Linear(64, len(action.choices)))
adam, seen = torch.optim.Adam(network.parameters(), 3e-3), torch.from_numpy(states.features)
wanted = torch.from_numpy((states.labels[:, None] == action.choices).all(2).argmax(1))
for _ in range(int(steps)):
    adam.zero_grad()
    torch.nn.functional.cross_entropy(network(seen), wanted).backward()
    adam.step()
policy = sheath.from_torch(network, embed="1", action=action)
fit = sheath.fit_gate(policy, states, held_out, GATE, sources=sheath.Sources())
checkpoint = sheath.Checkpoint(task.name, "network", policy, fit.gate)
episode = sheath.gated_episode(task, checkpoint, "one-stage", seed=7)
takeover = np.flatnonzero(~episode.columns.by_policy)
print(f"{episode.outcome}; the expert acted in {len(takeover)} of {len(episode)} steps")
Image.fromarray(sheath.contact_sheet(task, episode, (0, takeover[0], -1))).save(path)
