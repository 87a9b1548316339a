"""States beside those of the expert, made from its new episodes by the task's displacements."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from sheath_manip.experiments.gates.setting import Setting
from sheath_manip.files.outputs import written_aside
from sheath_manip.protocols import Report, require_restorable
from sheath_manip.seeding import generator
from sheath_manip.types import Observation
from sheath_manip.types.samples import Samples

FILE = "displaced.npz"


def displaced_states(setting: Setting, report: Report = lambda _: None) -> Mapping[str, Samples]:
    """Return the states by displacement, read where there are some, else made and written."""
    path = setting.directory / FILE
    if not path.exists():
        _write(path, _made(setting, report))
    return _read(path)


def _made(setting: Setting, report: Report) -> Mapping[str, Samples]:
    """Every so many steps of each new episode, each displacement once; labelled by the expert."""
    plan, displacements = setting.plan, setting.probes.displacements
    environment = setting.environment()
    restorable = require_restorable(environment, "displaced states")
    expert = setting.task.expert(environment)
    seen: dict[str, list[tuple[Observation, np.ndarray, int]]] = {
        displacement.name: [] for displacement in displacements
    }
    try:
        for number, episode in enumerate(setting.fresh()[: plan.displaced_episodes]):
            rng = generator("displaced", setting.seed, number)
            environment.reset(episode.info.seed)
            expert.reset()
            for step in episode.steps[:: plan.displaced_every]:
                for displacement in displacements:
                    restorable.restore(step.state)
                    observation = displacement.apply(environment, rng)
                    seen[displacement.name].append((observation, expert.act(observation), number))
            report("displaced states")
    finally:
        environment.close()
    return {name: _samples(states) for name, states in seen.items()}


def _samples(states: list[tuple[Observation, np.ndarray, int]]) -> Samples:
    observations, labels, episodes = zip(*states, strict=True)
    return Samples(
        {
            camera: np.stack([observation.images[camera] for observation in observations])
            for camera in observations[0].images
        },
        np.stack([observation.features for observation in observations]),
        np.stack(labels),
        np.array(episodes, dtype=np.int64),
    )


def _write(path: Path, states: Mapping[str, Samples]) -> None:
    """In one stroke: the file is there whole or not at all."""
    arrays = {}
    for name, samples in states.items():
        parts = {
            "features": samples.features,
            "labels": samples.labels,
            "episodes": samples.episodes,
            **{f"images/{camera}": images for camera, images in samples.images.items()},
        }
        arrays |= {f"{name}|{part}": array for part, array in parts.items()}
    with written_aside(path) as aside, aside.open("wb") as file:
        np.savez(file, **arrays)


def _read(path: Path) -> Mapping[str, Samples]:
    parts: dict[str, dict[str, np.ndarray]] = {}
    with np.load(path, allow_pickle=False) as content:
        for key in content.files:
            name, _, part = key.rpartition("|")
            parts.setdefault(name, {})[part] = content[key]
    return {
        name: Samples(
            {
                part.removeprefix("images/"): array
                for part, array in held.items()
                if part.startswith("images/")
            },
            held["features"],
            held["labels"],
            held["episodes"],
        )
        for name, held in parts.items()
    }
