"""Every method's checkpoints: what its first policy is, its gate, and the episodes behind it."""

from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.gates import SupportGate
from sheath_manip.learning.checkpoint import Checkpoint, digest, load_checkpoint
from sheath_manip.learning.methods import METHODS
from sheath_manip.learning.results import round_path
from sheath_manip.types import Purpose
from tests.buttons import PLAN, SPEC
from tests.learning.buttons_run import ORDER, episodes, uninterrupted


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    return uninterrupted(tmp_path_factory)


def test_a_method_with_another_gate_begins_with_the_shared_policy(whole):
    def checkpoint(method: str) -> Checkpoint:
        return load_checkpoint(round_path(whole, 0, method, 0, "npz"), SPEC)

    shared = checkpoint("expert").policy.arrays()
    for name in sorted(set(METHODS) - {"sheath", "smile"}):
        for key, array in checkpoint(name).policy.arrays().items():
            np.testing.assert_array_equal(array, shared[key])
        drove = {episode.info.checkpoint for episode in episodes(whole, name, 1)}
        assert drove == {digest(round_path(whole, 0, name, 0, "npz"))}
    smile = checkpoint("smile").policy.arrays()
    np.testing.assert_array_equal(smile["0/machines"], shared["machines"])
    assert not round_path(whole, 0, "sheath", 0, "npz").exists()
    drove = {episode.info.checkpoint for episode in episodes(whole, "sheath", 1)}
    assert drove == {digest(round_path(whole, 0, "expert", 0, "npz"))}


def test_what_holds_or_labels_otherwise_is_not_fitted_for_that(whole):
    shared = load_checkpoint(round_path(whole, 0, "expert", 0, "npz"), SPEC)
    for name in ("sheath-own-labels", "shiv"):
        own = load_checkpoint(round_path(whole, 0, name, 0, "npz"), SPEC)
        assert own.fitted.config == METHODS[name].plan(PLAN).gate != shared.fitted.config
        assert (own.threshold, own.training_loss) == (shared.threshold, shared.training_loss)
        for key, array in own.fitted.fitted_signal.arrays().items():
            np.testing.assert_array_equal(array, shared.fitted.fitted_signal.arrays()[key])


def test_every_checkpoint_knows_its_gate_and_its_episodes(whole):
    store = EpisodeStore(whole / "store")
    expert = {each.name: each.info for each in store.infos() if each.info.method == "expert"}
    for name in ORDER:
        for number in (1, 2):
            checkpoint = load_checkpoint(round_path(whole, 0, name, number, "npz"), SPEC)
            config = checkpoint.fitted.config
            given = {"expert_share": config.expert_share, "blocks": asdict(config.blocks)}
            wanted = METHODS[name].plan(PLAN).changed(gate=given)
            assert checkpoint.fitted.config == wanted.gate
            assert (checkpoint.fitted.signal is not None) is METHODS[name].uses_signal(PLAN)
            sources = checkpoint.fitted.sources
            assert [expert[each].index for each in sources.held_out] == [0, 1, 2]
            assert {expert[each].purpose for each in sources.held_out} == {Purpose.CALIBRATION}
            learned = {
                each.name
                for each in store.infos()
                if each.queries
                and each.info.purpose in (Purpose.DEMONSTRATION, Purpose.LEARNING)
                and each.info.method in ("expert", name)
                and each.info.round <= number
            }
            assert set(sources.fitted_to) == learned
            assert len(sources.fitted_to) == len(learned)


def test_the_plain_gate_is_the_drafts(whole):
    checkpoint = load_checkpoint(round_path(whole, 0, "sheath-plain", 2, "npz"), SPEC)
    assert checkpoint.threshold == 0
    assert checkpoint.fitted.config.signal == "support"
    learned = checkpoint.fitted.fitted_signal.arrays()
    assert learned["support/c"] == pytest.approx(0.01 * len(SPEC.feature_names))


def test_the_lazy_gate_hands_back_later_than_it_takes_over(whole):
    checkpoint = load_checkpoint(round_path(whole, 0, "lazy-dagger", 0, "npz"), SPEC)
    assert checkpoint.fitted.release_margin > 0
    gate = checkpoint.gate()
    assert isinstance(gate, SupportGate)
    assert (gate.release_margin, gate.query) == (checkpoint.fitted.release_margin, False)
    sheath = load_checkpoint(round_path(whole, 0, "expert", 0, "npz"), SPEC)
    assert (sheath.fitted.release_margin, sheath.threshold) == (0, checkpoint.threshold)
