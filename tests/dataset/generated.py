"""Generated episodes, of any shape or of a task's."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from sheath_manip.types import (
    Actor,
    Breakdown,
    Episode,
    EpisodeInfo,
    GateDecision,
    Limited,
    Observation,
    Outcome,
    Purpose,
    Reason,
    SignalScore,
    Step,
    TaskSpec,
)

any_float = st.floats()
finite_32 = st.floats(width=32, allow_nan=False, allow_infinity=False)
any_text = st.text(max_size=12)
# JSON tells no NaN from another.
metric = st.floats(allow_nan=False) | st.just(float("nan"))
limited = st.dictionaries(any_text, st.floats(allow_nan=False), max_size=3).map(
    lambda by: tuple(Limited(*pair) for pair in sorted(by.items()))
)
breakdowns = st.builds(Breakdown, st.sampled_from(["policy", "gate"]), any_text)
signals = st.dictionaries(
    any_text, st.tuples(st.floats(allow_nan=False), any_float), max_size=3
).map(lambda scores: tuple(SignalScore(name, *scores[name]) for name in sorted(scores)))
camera_names = st.from_regex(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,8}", fullmatch=True)
infos = st.builds(
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
    variant=any_text,
    session=st.from_regex(r"[0-9A-Za-z]{0,8}", fullmatch=True),
)


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
        # One for the whole episode.
        st.just(draw(st.just("") | any_text)),
    )
    state = arrays(np.float64, states, elements=any_float)
    decision = st.builds(
        GateDecision,
        st.sampled_from(Actor),
        st.booleans(),
        st.sampled_from(Reason),
        any_float,
        any_float,
        st.lists(breakdowns, max_size=2).map(tuple),
        st.floats(0, 1e6),
        signals,
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
    return Episode(
        draw(infos),
        tuple(draw(st.lists(step, min_size=1, max_size=4))),
        draw(observation),
        draw(state),
        draw(st.booleans()),
        draw(st.booleans()),
        draw(st.sampled_from(Outcome)),
        draw(st.dictionaries(any_text, metric, max_size=3)),
        draw(st.none() | breakdowns),
    )


def of_task(spec: TaskSpec, seed: int, count: int = 2, longest: int = 5) -> list[Episode]:
    """Noise in the shapes of a task, with labels and proposals here and there and NaN scores."""
    rng = np.random.default_rng(seed)
    state_size = int(rng.integers(0, 6))

    def one_of(options: Sequence[Any]) -> Any:
        return options[int(rng.integers(len(options)))]

    def observed() -> Observation:
        images = {
            camera: rng.integers(0, 256, (*size, 3), np.uint8)
            for camera, size in spec.cameras.items()
        }
        features = rng.normal(size=len(spec.feature_names)).astype(np.float32)
        return Observation(images, features, float(rng.normal()))

    def act() -> np.ndarray:
        return rng.normal(size=len(spec.action.names)).astype(np.float32)

    def step() -> Step:
        decision = GateDecision(
            one_of(list(Actor)),
            bool(rng.integers(2)),
            one_of(list(Reason)),
            float(rng.choice([rng.normal(), np.nan, np.inf, -0.0])),
            float(rng.normal()),
        )
        proposed = act() if rng.integers(2) else None
        labelled = act() if rng.integers(3) else None
        # As a command filter reports: nothing most of the time.
        names = sorted(name for name in ("jerk", "speed") if rng.random() < 0.2)
        limited = tuple(Limited(name, float(rng.random())) for name in names)
        return Step(
            observed(),
            rng.normal(size=state_size),
            proposed,
            labelled,
            decision,
            act(),
            0.5,
            limited,
        )

    return [
        Episode(
            EpisodeInfo(
                spec.name,
                int(rng.integers(2**40)),
                one_of(list(Purpose)),
                spec.control_rate_hz,
                method=one_of(["", "sheath", "α/β"]),
                round=int(rng.integers(4)),
                index=index,
            ),
            tuple(step() for _ in range(rng.integers(1, longest + 1))),
            observed(),
            rng.normal(size=state_size),
            bool(rng.integers(2)),
            bool(rng.integers(2)),
            one_of(list(Outcome)),
            {"progress": float(rng.choice([rng.normal(), np.nan]))},
        )
        for index in range(count)
    ]
