import json
import tempfile
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from sheath_manip.dataset.check import check
from sheath_manip.dataset.header import header_of, read_header, to_attributes
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.steps import arrays_of, episode_from
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.types import (
    Actor,
    Episode,
    EpisodeInfo,
    GateDecision,
    Limited,
    Observation,
    Outcome,
    Purpose,
    Reason,
    Step,
)
from tools.kill_recorder import identical

any_float = st.floats()
finite_32 = st.floats(width=32, allow_nan=False, allow_infinity=False)
any_text = st.text(max_size=12)
# JSON tells no NaN from another.
metric = st.floats(allow_nan=False) | st.just(float("nan"))
limited = st.dictionaries(any_text, st.floats(allow_nan=False), max_size=3).map(
    lambda by: tuple(Limited(*pair) for pair in sorted(by.items()))
)
camera_names = st.from_regex(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,8}", fullmatch=True)


@st.composite
def episodes(draw: st.DrawFn) -> Episode:
    cameras = draw(
        st.dictionaries(camera_names, st.tuples(st.integers(1, 4), st.integers(1, 4)), max_size=2)
    )
    features, states = draw(st.integers(0, 3)), draw(st.integers(0, 4))
    action = arrays(np.float32, draw(st.integers(1, 3)), elements=finite_32)
    observation = st.builds(
        Observation,
        st.fixed_dictionaries(
            {name: arrays(np.uint8, (*size, 3)) for name, size in cameras.items()}
        ),
        arrays(np.float32, features, elements=st.floats(width=32)),
        any_float,
    )
    state = arrays(np.float64, states, elements=any_float)
    decision = st.builds(
        GateDecision,
        st.sampled_from(Actor),
        st.booleans(),
        st.sampled_from(Reason),
        any_float,
        any_float,
    )
    step = st.builds(
        Step,
        observation,
        state,
        st.none() | action,
        st.none() | action,
        decision,
        action,
        any_float,
        limited,
    )
    info = st.builds(
        EpisodeInfo,
        task=any_text,
        seed=st.integers(0, 2**63),
        purpose=st.sampled_from(Purpose),
        control_rate_hz=st.floats(0.1, 1000),
        method=any_text,
        round=st.integers(0, 200),
        index=st.integers(0, 2000),
        run_seed=st.integers(0, 2**32),
        checkpoint=any_text,
    )
    return Episode(
        draw(info),
        tuple(draw(st.lists(step, min_size=1, max_size=4))),
        draw(observation),
        draw(state),
        draw(st.booleans()),
        draw(st.booleans()),
        draw(st.sampled_from(Outcome)),
        draw(st.dictionaries(any_text, metric, max_size=3)),
    )


@settings(max_examples=30, deadline=None)
@given(episodes())
def test_header_and_arrays_hold_all_of_an_episode(episode: Episode) -> None:
    header = header_of(episode)
    with tempfile.TemporaryDirectory() as folder:
        directory = Path(folder, episode_name(episode.info))
        directory.mkdir()
        # Strict JSON: other readers know no NaN.
        group = json.dumps({"attributes": to_attributes(header)}, allow_nan=False)
        (directory / "zarr.json").write_text(group)
        read = read_header(directory)
    assert identical(episode_from(read, arrays_of(episode, header)), episode)


# Few and without a deadline: the disk's speed is no property of the code.
@settings(max_examples=6, deadline=None)
@given(episodes())
def test_an_episode_comes_back_from_the_disk_to_the_bit(episode: Episode) -> None:
    with tempfile.TemporaryDirectory() as folder:
        store = EpisodeStore.create(folder)
        assert not store.has(episode.info)
        name = store.append(episode)
        assert store.has(episode.info)
        assert store.names() == [name]
        assert identical(store.read(name), episode)
        assert check(store) == []


def test_scalars_come_back_as_plain_python(store: EpisodeStore, episode: Episode) -> None:
    read = store.read(store.append(episode))
    decision = read.steps[0].decision
    assert type(decision.query) is bool
    assert type(decision.score) is type(read.steps[0].reward) is float
    assert type(read.final_observation.time_s) is type(read.metrics["distance_m"]) is float


def test_images_may_be_left_out(store: EpisodeStore, episode: Episode) -> None:
    read = store.read(store.append(episode), need_images=False)
    assert read.steps[0].observation.images == {} == read.final_observation.images
    assert np.array_equal(
        read.steps[-1].observation.features, episode.steps[-1].observation.features
    )
