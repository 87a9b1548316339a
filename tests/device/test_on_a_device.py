"""What a device computes is what the CPU does, up to rounding: actions, scores, decisions.

Without a CUDA device the same code runs by torch on the CPU, and what needs one is skipped.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from sheath_manip.gates.config import GateConfig
from sheath_manip.gates.fitted import Sources
from sheath_manip.learning.checkpoint import Checkpoint, load_checkpoint
from sheath_manip.learning.fitting import fit_gate
from sheath_manip.policies import make_policy
from sheath_manip.policies.cnn import ConvPolicy
from sheath_manip.policies.looking import look
from sheath_manip.policies.reconstruction import reconstruction_loss
from sheath_manip.signals.nearest_on_device import DeviceRows
from sheath_manip.signals.nearest_rows import NearestRows
from sheath_manip.support.block_solver import BlockSolver
from sheath_manip.support.gaussian import GaussianColumns, row_factor
from sheath_manip.support.gaussian_on_device import DeviceColumns
from sheath_manip.support.kernel_sum import KernelSum
from sheath_manip.types.samples import Samples
from tests import blobs, reach
from tests.device.stand_in import computing_on

NO_CUDA = pytest.mark.skipif(
    not torch.cuda.is_available(), reason="no CUDA device here to compare with the CPU"
)
DEVICES = ["cpu:0", pytest.param("cuda:0", marks=NO_CUDA)]
"""the first by the same code, on the CPU"""
on_devices = pytest.mark.parametrize("name", DEVICES)


def vectors(seed: int, count: int, width: int = 6) -> np.ndarray:
    return np.random.default_rng(seed).normal(size=(count, width)).astype(np.float32)


@on_devices
@pytest.mark.parametrize("count", [1, 40])
def test_sums_of_kernels(name, count):
    fixed, weights = vectors(0, count), np.random.default_rng(1).uniform(size=count)
    here = GaussianColumns(fixed, weights, 8.0)
    there = DeviceColumns(fixed, weights, 8.0, torch.device(name))
    rows = row_factor(vectors(2, 30), 0.0)
    np.testing.assert_allclose(there.sums(rows), here.sums(rows), rtol=1e-5)
    assert there.sum_of(rows[3]) == pytest.approx(here.sum_of(rows[3]), rel=1e-5)
    assert there.sums(rows[:0]).shape == (0,)


@on_devices
@pytest.mark.parametrize("tile", [1, 100, 1 << 20])
@pytest.mark.parametrize(("fixed", "count"), [(50, 1), (50, 3), (2, 3), (0, 1)])
def test_nearest_vectors(name, fixed, count, tile, monkeypatch):
    monkeypatch.setattr("sheath_manip.signals.nearest_on_device.TILE", tile)
    rows, new = vectors(0, fixed), vectors(1, 9)
    here, there = NearestRows(rows), DeviceRows(rows, torch.device(name))
    found = there.nearest(new, count)
    expected = np.sort(here.nearest(new, count), axis=1)
    np.testing.assert_allclose(np.sort(found, axis=1), expected, rtol=1e-4, atol=1e-5)
    np.testing.assert_array_equal(found[:, -1], found.max(axis=1))
    np.testing.assert_allclose(there.squares(new), here.squares(new), rtol=1e-4, atol=1e-5)


@on_devices
def test_a_large_support(name):
    points = vectors(0, 3000, width=4)
    points -= points.mean(axis=0)
    most, signs = np.full(len(points), 1 / (0.1 * len(points))), np.ones(len(points))
    solver = BlockSolver.of(points, 4.0, most, signs)
    here, rho = solver.solve()
    with computing_on(name):
        there, other_rho = solver.solve()
        other_sums = KernelSum(np.zeros(4), points, there, 4.0)(points)
    assert other_rho == pytest.approx(rho, rel=1e-4)
    sums = KernelSum(np.zeros(4), points, here, 4.0)(points)
    # Many lie on the boundary itself, where the last bit decides.
    edge = np.abs(sums - rho) < 1e-4 * rho
    assert ((sums >= rho) == (other_sums >= other_rho))[~edge].all()
    np.testing.assert_allclose(other_sums, sums, rtol=1e-3)


NEAR = GateConfig(
    signal="near-joined", embedding="camera-convolutions", precedent_embedding="pixels"
)
CASES = {
    "cnn": (blobs, GateConfig()),
    "spatial-cnn": (reach, NEAR),
    "act": (reach, NEAR),
    "mlp": (reach, replace(NEAR, embedding="mlp-hidden", precedent_embedding="scaled-features")),
}
"""by policy, the toy that it learns and the gate around it"""


def fresh(toy: Any) -> Samples:
    """States that no fit and no threshold has seen: those sit on steps of the scores."""
    return toy.blob_samples(300, 7) if toy is blobs else toy.reach_samples(300, 7)


@pytest.fixture(scope="module", params=CASES)
def kept(request, tmp_path_factory) -> tuple[Path, Any]:
    """A checkpoint that was fitted on the CPU, and its toy."""
    toy, config = CASES[request.param]
    if request.param == "mlp":
        policy = make_policy("mlp", toy.SPEC, steps=200).fit(toy.training())
    else:
        policy = toy.fitted_policy(request.param)
    episodes = np.unique(toy.held_out().episodes)
    held_out = [toy.held_out().take(toy.held_out().episodes == each) for each in episodes]
    fit = fit_gate(policy, toy.training(), held_out, config, sources=Sources((), ()))
    path = tmp_path_factory.mktemp(request.param) / "kept.npz"
    return Checkpoint(toy.SPEC.name, request.param, policy, fit.gate).save(path), toy


@on_devices
def test_a_checkpoint_of_the_cpu_decides_the_same_there(kept, name):
    path, toy = kept
    here = decided(path, toy)
    with computing_on(name):
        there = decided(path, toy)
    np.testing.assert_allclose(there.actions, here.actions, atol=1e-3)
    assert (there.taken_over == here.taken_over).mean() >= 0.999
    np.testing.assert_allclose(there.measures, here.measures, rtol=1e-3, atol=1e-4)


@dataclass(frozen=True)
class Decided:
    """What is proposed in states, what the signals measure, and where the expert takes over."""

    actions: np.ndarray
    measures: np.ndarray
    taken_over: np.ndarray


def decided(path: Path, toy: Any) -> Decided:
    checkpoint = load_checkpoint(path, toy.SPEC)
    signal = checkpoint.fitted.signal
    assert signal is not None
    seen = look(checkpoint.policy, fresh(toy), signal.attach(checkpoint.policy))
    scores = checkpoint.fitted.scores_of(seen)
    return Decided(seen.actions, signal.measure(seen), scores < checkpoint.threshold)


@on_devices
def test_what_is_fitted_there_loads_here(name, tmp_path):
    settings = {**reach.SETTINGS, "steps": 60}
    with computing_on(name):
        policy = make_policy("spatial-cnn", reach.SPEC, **settings).fit(reach.training())
        episodes = np.unique(reach.held_out().episodes)
        held_out = [reach.held_out().take(reach.held_out().episodes == each) for each in episodes]
        fit = fit_gate(policy, reach.training(), held_out, NEAR, sources=Sources((), ()))
        path = tmp_path / "there.npz"
        Checkpoint(reach.SPEC.name, "spatial-cnn", policy, fit.gate).save(path)
        there = decided(path, reach)
    here = decided(path, reach)
    np.testing.assert_allclose(there.actions, here.actions, atol=1e-3)
    assert (there.taken_over == here.taken_over).mean() >= 0.999
    assert load_checkpoint(path, reach.SPEC).device == name


def test_the_stand_in_learns_the_same_weights_as_the_cpu():
    settings = {**reach.SETTINGS, "steps": 20}
    here = make_policy("spatial-cnn", reach.SPEC, **settings).fit(reach.training()).arrays()
    with computing_on("cpu:0"):
        there = make_policy("spatial-cnn", reach.SPEC, **settings).fit(reach.training()).arrays()
    for layer, weights in here.items():
        np.testing.assert_array_equal(weights, there[layer])


META = torch.device("meta")
"""has shapes alone, and refuses to mix with what is on the CPU"""


def images(side: int, count: int = 2) -> torch.Tensor:
    return torch.empty((count, side, side, 3), dtype=torch.uint8, device=META)


@pytest.mark.parametrize("painting", [0.0, 1.0])
def test_a_network_of_choices_makes_nothing_on_the_cpu(painting):
    policy = ConvPolicy(blobs.SPEC, reconstruction_weight=painting)
    network = policy.fresh_network(weights=False)
    last = network.activations(images(125))[-1]
    assert network.logits(last).device == META
    if network.decoder is not None:
        assert reconstruction_loss(network.decoder(last), images(125)).device == META


@pytest.mark.parametrize("name", ["spatial-cnn", "act"])
def test_a_network_of_cameras_makes_nothing_on_the_cpu(name):
    settings = reach.ACT_SETTINGS if name == "act" else reach.SETTINGS
    policy: Any = make_policy(name, reach.SPEC, **settings)
    network = policy.fresh_network(weights=False)
    shown = {camera: images(side) for camera, (side, _) in reach.SPEC.cameras.items()}
    felt = torch.empty((2, len(reach.SPEC.feature_names)), device=META)
    layers = network.activations(shown)
    outputs = network(layers, felt) if name == "act" else network.outputs(layers, felt)
    assert outputs.device == META
