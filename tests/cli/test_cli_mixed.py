"""Stores whose episodes differ: every verb refuses what does not fit, or names it."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from sheath_manip.cli.entry import run_command
from sheath_manip.cli.session import Catalog
from sheath_manip.dataset.places import archive_path
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.types import Action, ActionSpec, Observation, Purpose, Transition
from tests.episodes import INFO, episode_of
from tests.toy import CORRIDOR, STUDY, Corridor, MiddleKeeper


def slow() -> Corridor:
    corridor = Corridor()
    corridor.spec = replace(corridor.spec, control_rate_hz=25.0)
    return corridor


def renamed() -> Corridor:
    corridor = Corridor()
    corridor.spec = replace(corridor.spec, feature_names=("x_m", "along_m"))
    return corridor


def stronger() -> Corridor:
    corridor = Corridor()
    action = corridor.spec.action
    wider = ActionSpec(action.names, 2 * action.minimum, action.maximum, action.choices)
    corridor.spec = replace(corridor.spec, action=wider)
    return corridor


class Small(Corridor):
    """Its camera has half the pixels a side."""

    def __init__(self) -> None:
        super().__init__()
        self.spec = replace(self.spec, cameras={"above": (32, 32)})

    def reset(self, seed: int) -> Observation:
        return _halved(super().reset(seed))

    def step(self, action: Action) -> Transition:
        transition = super().step(action)
        return replace(transition, observation=_halved(transition.observation))


def _halved(observation: Observation) -> Observation:
    return replace(observation, images={"above": observation.images["above"][::2, ::2].copy()})


POLICY = ("--policy.name", "hog-svm")
GATE = ("--gate.signal", "support", "--gate.embedding", "pixels")
OTHERS = {
    slow: "control rate 25 Hz instead of 50 Hz",
    renamed: "features 'along_m' instead of 'y_m'",
    stronger: "lower bounds -0.6 instead of -0.3",
    Small: "cameras above 32x32 instead of above 64x64",
}


def collect(make: Callable[[], Corridor], store: Path) -> int:
    """Record scenes of a corridor as `make` makes it."""
    task = replace(CORRIDOR, variants={"default": make, "other": make}, expert=MiddleKeeper)
    argv = ["collect", "corridor", "--store", str(store), "--episodes", "9"]
    return run_command(lambda: Catalog({"corridor": task}, {"corridor": STUDY}), argv)


@pytest.fixture
def mixed(made, tmp_path) -> Callable[[Callable[[], Corridor]], Path]:
    """A store of 8 demonstrations and of one more by another corridor, put there by hand."""

    def mix(make: Callable[[], Corridor]) -> Path:
        store, other = tmp_path / "mixed", tmp_path / "other"
        assert collect(make, other) == 0
        shutil.copytree(made / "store", store)
        name = EpisodeStore(other).names()[-1]
        shutil.copy(archive_path(other, name), archive_path(store, name))
        return store

    return mix


@pytest.mark.parametrize("make", OTHERS)
def test_what_differs_is_refused_in_one_line(complaint, made, mixed, tmp_path, make) -> None:
    store, told = mixed(make), OTHERS[make]
    train = ("train", "corridor", "--store", store, "--checkpoint", tmp_path / "c.npz")
    assert told in complaint(*train)
    assert told in complaint(*train, "--cache", tmp_path / "cache")
    assert not (tmp_path / "c.npz").exists()
    # Whichever comes first is what the other does not fit.
    complaint("data", "merge", store, "--into", tmp_path / "all")
    assert EpisodeStore(tmp_path / "all").names() == []
    assert "does not fit" in complaint(
        "data", "export", store, tmp_path / "x.hdf5", "--format", "robomimic"
    )
    watch = ("dashboard", "corridor", "--checkpoint", made / "first.npz", "--port", 0)
    # The demonstrations of the same names, but by the other corridor.
    assert told in complaint(*watch, "--store", tmp_path / "other", "--episodes", 1)
    show = ("replay", store, "--episode", "-1", "--once", "--port", 0)
    assert told in complaint(*show)


def test_nothing_else_is_recorded_beside(complaint, tmp_path) -> None:
    assert collect(slow, tmp_path / "store") == 0
    argv = ("collect", "corridor", "--store", tmp_path / "store", "--episodes", 1, "--seed", 5)
    assert "what is to be recorded does not fit" in complaint(*argv)


def test_a_variant_is_trained_on_as_it_is(complaint, tmp_path) -> None:
    """A store of one variant, whose actions the default has not, and a page of it."""
    task = replace(CORRIDOR, variants={"default": Corridor, "other": stronger})
    tasks = {"corridor": task}
    store, checkpoint = str(tmp_path / "store"), str(tmp_path / "c.npz")
    small = [*POLICY, *GATE]
    for argv in (
        ["collect", "corridor", "--store", store, "--episodes", "5", "--variant", "other"],
        ["train", "corridor", "--store", store, "--checkpoint", checkpoint, *small],
        ["replay", store, "--once", "--speed", "50", "--port", "0"],
    ):
        assert run_command(lambda: Catalog(tasks, {"corridor": STUDY}), argv) == 0
    # Where there is no such variant, that is what is said.
    assert "variant of corridor 'other'" in complaint("replay", store, "--once", "--port", 0)


def test_train_names_variants_and_failures(sheath, made, tmp_path) -> None:
    shutil.copytree(made / "store", tmp_path / "store")
    store = EpisodeStore(tmp_path / "store")
    options = ("--store", store.path, "--episodes", 1, "--variant", "final")
    assert sheath("collect", "corridor", *options)[0] == 0
    small = (*POLICY, *GATE)
    train = ("train", "corridor", "--store", store.path, "--checkpoint", tmp_path / "c.npz")
    code, out, _ = sheath(*train, *small)
    assert code == 0
    assert "episodes, 6 succeeded" in out
    assert "episodes of several variants: 8 of 'default', 1 of 'final'" in out


def test_replay_of_a_variant_wants_episodes_that_do_not_say_theirs(
    complaint, sheath, made, tmp_path
) -> None:
    replay = ("replay", made / "store", "--variant", "final")
    line = complaint(*replay, "--port", 0)
    assert "--variant final is for old episodes that do not say theirs; all 8 of" in line
    # One of before there was a variant.
    store = EpisodeStore.create(tmp_path / "store")
    first, *others = EpisodeStore(made / "store").episodes()
    for episode in (replace(first, info=replace(first.info, variant="")), *others[:2]):
        store.append(episode)
    old = ("replay", store.path, "--variant", "default", "--export", tmp_path / "x.html")
    code, out, _ = sheath(*old)
    assert code == 0
    assert "2 of 3 episodes say their own variant, and are shown in it" in out


def test_two_sessions_by_hand_unite(sheath, tmp_path) -> None:
    info = replace(INFO, purpose=Purpose.DEMONSTRATION, method="person")
    for day, actors in (("monday", "eee"), ("friday", "ee")):
        store = EpisodeStore.create(tmp_path / day)
        for index in range(2):
            store.append(episode_of(actors, info=replace(info, index=index)))
    days = (tmp_path / "monday", tmp_path / "friday")
    code, out, _ = sheath("data", "merge", *days, "--into", tmp_path / "all")
    assert code == 0
    assert out.startswith("4 episodes copied into ")
    assert out.count("another episode had its name: now demonstration-person-s0-r00-") == 2
    assert "4 of 4 episodes do not say what their features" in out
    code, out, _ = sheath("data", "merge", *days, "--into", tmp_path / "all")
    assert (code, out.startswith("0 episodes copied")) == (0, True)
    assert len(EpisodeStore(tmp_path / "all").names()) == 4
