"""The ways in which a call may go wrong, to any part; each takes the call's place."""

import socket
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from sheath_manip.exceptions import ParameterError
from sheath_manip.types import (
    Actor,
    GateDecision,
    Observation,
    Proposal,
    Reason,
    Transition,
)

Way = Callable[..., Any]
"""(call, *arguments): what becomes of the call; it may make it or not"""


class OutOfMemoryError(RuntimeError):
    """As torch calls its own."""


class SpeechlessError(Exception):
    """An error that cannot even be printed."""

    def __str__(self) -> str:
        raise RuntimeError("no words")


def raising(error: Callable[[], BaseException]) -> Way:
    def way(call: Any, *arguments: Any) -> Any:
        del call, arguments
        raise error()

    return way


def too_deep(call: Any, *arguments: Any) -> Any:
    return too_deep(call, *arguments)


def afterwards(call: Any, *arguments: Any) -> Any:
    """Do it, then fail: a robot has moved, and nobody is told how."""
    call(*arguments)
    raise ConnectionResetError("the robot moved and the line went dead")


def answering(answer: Callable[[], Any]) -> Way:
    def way(call: Any, *arguments: Any) -> Any:
        del call, arguments
        return answer()

    return way


def twisted(twist: Callable[[Any], Any]) -> Way:
    """The answer, made rubbish."""

    def way(call: Any, *arguments: Any) -> Any:
        return twist(call(*arguments))

    return way


def late(seconds: float) -> Way:
    def way(call: Any, *arguments: Any) -> Any:
        time.sleep(seconds)
        return call(*arguments)

    return way


RAISING: Mapping[str, Way] = {
    "ValueError": raising(lambda: ValueError("boom")),
    "KeyError": raising(lambda: KeyError("latent")),
    "IndexError": raising(lambda: IndexError(7)),
    "TypeError": raising(lambda: TypeError("None")),
    "AttributeError": raising(lambda: AttributeError("x")),
    "RuntimeError": raising(lambda: RuntimeError("CUDA error: an illegal memory access")),
    "OutOfMemoryError": raising(lambda: OutOfMemoryError("CUDA out of memory")),
    "MemoryError": raising(MemoryError),
    "AssertionError": raising(AssertionError),
    "ZeroDivisionError": raising(lambda: ZeroDivisionError("division by zero")),
    "FloatingPointError": raising(lambda: FloatingPointError("underflow")),
    "StopIteration": raising(StopIteration),
    "NotImplementedError": raising(NotImplementedError),
    "OSError": raising(lambda: OSError(28, "No space left on device")),
    "TimeoutError": raising(lambda: TimeoutError("the server does not answer")),
    "UnicodeDecodeError": raising(lambda: UnicodeDecodeError("utf-8", b"\xff", 0, 1, "bad")),
    "ParameterError": raising(lambda: ParameterError("the policy is not fitted yet")),
    "many lines and colours": raising(lambda: ValueError("a\nb\r\n\x1b[31mred\x07" + "x" * 9999)),
    "no words": raising(SpeechlessError),
    "an odd class": raising(lambda: type("\x1b]0;owned\x07\n", (Exception,), {})("odd")),
    "an error group": raising(lambda: ExceptionGroup("two", [ValueError("a"), KeyError("b")])),
    "endless recursion": too_deep,
}


class Obstinate:
    """Converts to an array as it likes: not at all."""

    def __array__(self, *_: Any, **__: Any) -> Any:
        raise RuntimeError("no array of mine")


def _masked() -> Any:
    return np.ma.masked_array(np.zeros(1, np.float32), mask=[True])


def _tensor_with_gradient() -> Any:
    import torch

    return torch.zeros(1, requires_grad=True)


NO_ACTIONS: Mapping[str, Callable[[], Any]] = {
    "None": lambda: None,
    "text": lambda: "left",
    "a list of text": lambda: ["0.0"],
    "bytes": lambda: b"\0\0\0\0",
    "complex": lambda: np.array([0.1 + 3j]),
    "complex number": lambda: [1j],
    "masked": _masked,
    "a list of masked": lambda: [_masked()],
    "structured": lambda: np.zeros(1, [("x", np.float32)]),
    "objects": lambda: np.array([object()]),
    "truth values": lambda: [True],
    "dates": lambda: np.array(["2020-01-01"], "datetime64[D]"),
    "too large an integer": lambda: [10**400],
    "a gradient": _tensor_with_gradient,
    "an obstinate array": Obstinate,
    "NaN": lambda: [np.nan],
    "infinite": lambda: np.array([np.inf], np.float32),
    "too large a float": lambda: [1e300],
    "out of bounds": lambda: [0.31],
    "just out of bounds": lambda: [0.30001],
    "too long": lambda: [0.0, 0.0],
    "empty": lambda: [],
    "a number": lambda: 0.0,
    "a dictionary": lambda: {"sidestep_m": 0.0},
    "ragged": lambda: [[0.0], [0.0, 0.1]],
    "endless": lambda: iter(int, 1),
}
"""what is no action of the toy corridor"""

NO_PROPOSALS: Mapping[str, Callable[[], Any]] = {
    **{f"of {name}": lambda make=make: Proposal([make()]) for name, make in NO_ACTIONS.items()},  # pyright: ignore[reportArgumentType]
    "nothing": lambda: None,
    "a bare array": lambda: np.zeros((1, 1), np.float32),
    "for two states": lambda: Proposal(np.zeros((2, 1), np.float32)),
    "for no state": lambda: Proposal(np.zeros((0, 1), np.float32)),
    "latents of NaN": lambda: Proposal(
        np.zeros((1, 1), np.float32), {"scores": np.array([[0.0, np.nan]])}
    ),
    "infinite latents": lambda: Proposal(
        np.zeros((1, 1), np.float32), {"penultimate": np.full((1, 8), np.inf, np.float32)}
    ),
    "latents of no mapping": lambda: Proposal(np.zeros((1, 1), np.float32), [1]),  # pyright: ignore[reportArgumentType]
    "a chunk that ends in text": lambda: Proposal([[[0.0], ["x"]]]),  # pyright: ignore[reportArgumentType]
    "a chunk that ends in NaN's own object": lambda: Proposal([[[0.0], [None]]]),  # pyright: ignore[reportArgumentType]
}


def _decided(**fields: Any) -> GateDecision:
    content: dict[str, Any] = {"actor": Actor.POLICY, "query": False, "reason": Reason.INSIDE}
    return GateDecision(**(content | fields))


NO_DECISIONS: Mapping[str, Callable[[], Any]] = {
    "None": lambda: None,
    "text": lambda: "policy",
    "a tuple": lambda: (Actor.POLICY, True),
    "an actor": lambda: Actor.POLICY,
    "an unknown actor": lambda: _decided(actor="someone"),
    "no actor": lambda: _decided(actor=None),
    "an unknown reason": lambda: _decided(reason="because"),
    "a score of two": lambda: _decided(score=np.zeros(2)),
    "a complex score": lambda: _decided(score=1j),
    "a score in words": lambda: _decided(score="high"),
    "a score beyond floats": lambda: _decided(score=10**400),
    "a query of two": lambda: _decided(query=np.array([True, False])),
    "no threshold": lambda: _decided(threshold=None),
    "breakdowns in words": lambda: _decided(broken=("policy",)),
}


def _observation(**fields: Any) -> Callable[[Observation], Observation]:
    def twist(seen: Observation) -> Observation:
        content = {"images": seen.images, "features": seen.features, "time_s": seen.time_s}
        made = {name: make(content[name]) for name, make in fields.items()}
        return Observation(**(content | made))

    return twist


NO_OBSERVATIONS: Mapping[str, Callable[[Observation], Any]] = {
    "None": lambda seen: None,  # noqa: ARG005
    "a dictionary": lambda seen: {"features": seen.features},
    "another shape": _observation(images=lambda images: {n: i[:-1] for n, i in images.items()}),
    "float images": _observation(images=lambda images: {n: i / 255 for n, i in images.items()}),
    "no camera": _observation(images=lambda images: {}),  # noqa: ARG005
    "another camera": _observation(images=lambda images: {"wrist": images["above"]}),
    "an image of text": _observation(images=lambda images: {"above": "picture"}),  # noqa: ARG005
    "float64 features": _observation(features=lambda f: f.astype(np.float64)),
    "NaN features": _observation(features=lambda f: f * np.float32(np.nan)),
    "infinite features": _observation(features=lambda f: f + np.float32(np.inf)),
    "a feature more": _observation(features=lambda f: np.append(f, np.float32(0))),
    "features in a list": _observation(features=lambda f: f.tolist()),
    "no time": _observation(time_s=lambda t: None),  # noqa: ARG005
    "time in words": _observation(time_s=lambda t: "now"),  # noqa: ARG005
    "NaN time": _observation(time_s=lambda t: t * np.nan),
}


def _transition(**fields: Any) -> Callable[[Transition], Transition]:
    def twist(made: Transition) -> Transition:
        content = {
            name: getattr(made, name)
            for name in ("observation", "reward", "terminated", "truncated", "commanded")
        }
        return Transition(**(content | {name: f(content[name]) for name, f in fields.items()}))

    return twist


NO_TRANSITIONS: Mapping[str, Callable[[Transition], Any]] = {
    **{
        f"observing {name}": _transition(observation=twist)
        for name, twist in NO_OBSERVATIONS.items()
    },
    "None": lambda made: None,  # noqa: ARG005
    "a tuple": lambda made: (made.observation, 0.0, False, {}),
    "a reward in words": _transition(reward=lambda _: "1.0"),
    "no reward": _transition(reward=lambda _: None),
    "a reward of two": _transition(reward=lambda _: np.zeros(2)),
    "ended in words": _transition(terminated=lambda _: "no"),
    "no end": _transition(truncated=lambda _: None),
    "commanded in words": _transition(commanded=lambda _: "hold"),
}

NO_STATES: Mapping[str, Callable[[Any], Any]] = {
    "None": lambda _: None,
    "a list": lambda state: state.tolist(),
    "integers": lambda state: state.astype(int),
    "another size": lambda state: np.append(state, 0.0),
    "two axes": lambda state: state[None],
}
NO_METRICS: Mapping[str, Callable[[], Any]] = {
    "None": lambda: None,
    "a figure None": lambda: {"progress": None},
    "a figure in words": lambda: {"progress": "0.5"},
    "a list": lambda: [0.5],
}
NO_OUTCOMES: Mapping[str, Callable[[], Any]] = {
    "None": lambda: None,
    "won": lambda: "won",
    "error": lambda: "error",
}


def asleep(call: Any, *arguments: Any) -> Any:
    del call, arguments
    time.sleep(600)


def locked(call: Any, *arguments: Any) -> Any:
    del call, arguments
    lock = threading.Lock()
    lock.acquire()
    lock.acquire()


def busy(call: Any, *arguments: Any) -> Any:
    del call, arguments
    while True:
        pass


def deaf(call: Any, *arguments: Any) -> Any:
    """A server that does not answer, and a loop that tries for ever."""
    del call, arguments
    ours, theirs = socket.socketpair()
    with ours, theirs:
        while True:
            try:
                ours.recv(1)
            except Exception:
                continue


HANGING: Mapping[str, Way] = {"asleep": asleep, "locked": locked, "busy": busy, "deaf": deaf}
