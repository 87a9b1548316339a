"""Cases of faults in the control loop: what goes wrong, when, and under which gate."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from sheath_manip.gates import AlwaysExpert, AlwaysPolicy, Mixture, SupportGate
from sheath_manip.rollout.watch import Deadline
from tests.faults import ways
from tests.faults.parts import (
    Faulty,
    Meddling,
    OneActionBuffer,
    OneActionExpert,
    OneBuffer,
    Onlooker,
    Scribbling,
    ScribblingListener,
    Straight,
    Witness,
)
from tests.faults.ways import Way
from tests.judging import always
from tests.toy import MiddleKeeper

HANG_S = 0.2
"""after which a call is broken off in these cases"""
DEADLINE = Deadline(share=4.0, hang_s=HANG_S)
"""80 ms of the corridor's 20: the machine that tests may be busy"""
TOO_LATE_S = 0.1

GATES: Mapping[str, Callable[[], Any]] = {
    "policy alone": AlwaysPolicy,
    "policy, labelled": lambda: AlwaysPolicy(query=True),
    "mixture": lambda: Mixture(0.5),
    "support": lambda: SupportGate(always(1.0), 0.0),
    "expert": AlwaysExpert,
}


@dataclass
class Cast:
    """All who take part in a case; a fault replaces one of them."""

    environment: Any
    policy: Any
    gate: Any
    expert: Any
    listeners: tuple[Any, ...]
    deadline: Deadline | None = None

    @property
    def faulty(self) -> Faulty | None:
        """The one that goes wrong."""
        parts = (self.environment, self.policy, self.gate, self.expert, *self.listeners)
        return next((part for part in parts if isinstance(part, Faulty)), None)


@dataclass(frozen=True)
class Case:
    """One fault."""

    kind: str
    """a row of the table in docs/reliability.md"""
    name: str
    part: str
    """the field of `Cast` that goes wrong"""
    method: str = ""
    way: Way | None = None
    first: int = 0
    times: int = 1
    gate: str = "mixture"
    other: Callable[[Any], Any] | None = None
    """makes another part of the sound one, in place of a method that goes wrong"""
    ends: bool = False
    """whether nobody is left, so that the attempt is cut short"""
    silent: bool = False
    """whether nothing is to be told: what it tries has no effect"""
    timed: bool = False

    def cast(self) -> Cast:
        """Return the cast with the fault in it."""
        environment = OneBuffer() if self.other is OneBuffer else Witness()
        cast = Cast(
            environment,
            Straight(),
            GATES[self.gate](),
            MiddleKeeper(environment),
            (Onlooker(),),
            DEADLINE if self.timed else None,
        )
        if self.part == "listener":
            cast.listeners = (self._spoilt(cast.listeners[0]), Onlooker())
        elif self.other is not OneBuffer:
            setattr(cast, self.part, self._spoilt(getattr(cast, self.part)))
        return cast

    def _spoilt(self, part: Any) -> Any:
        if self.other is not None:
            return self.other(part)
        assert self.way is not None
        return Faulty(part, self.method, self.way, self.first, self.times)


def all_cases() -> list[Case]:
    """Return every case, in an order that depends on nothing."""
    return [*_policy(), *_gate(), *_expert(), *_environment(), *_listener(), *_hanging(), *_kept()]


def few_of(cases: list[Case], each: int, seed: int) -> list[Case]:
    """Return a few cases of each kind, drawn anew by another seed."""
    rng = np.random.default_rng(seed)
    chosen = []
    for kind in dict.fromkeys(case.kind for case in cases):
        of_kind = [case for case in cases if case.kind == kind]
        places = rng.permutation(len(of_kind))[:each]
        chosen += [of_kind[place] for place in sorted(places)]
    return chosen


def _spread(items: Mapping[str, Any]) -> Iterator[tuple[str, Any, int, str]]:
    """Each way at a step and under a gate of its own."""
    gates = ("policy alone", "mixture", "support", "policy, labelled")
    for place, (name, way) in enumerate(items.items()):
        yield name, way, place % 9, gates[place % len(gates)]


def _policy() -> Iterator[Case]:
    for name, way, first, gate in _spread(ways.RAISING):
        yield Case("policy raises", name, "policy", "propose", way, first, 2, gate)
        yield Case("policy raises", f"{name}, always", "policy", "propose", way, 0, 99, gate)
    for name, make, first, gate in _spread(ways.NO_PROPOSALS):
        way = ways.answering(make)
        yield Case("policy answers rubbish", name, "policy", "propose", way, first, 2, gate)
    for name, way, _, gate in _spread(ways.RAISING):
        yield Case("policy cannot begin", name, "policy", "reset", way, 0, 1, gate)
    for first in (1, 5, 8):
        for gate in ("policy alone", "support"):
            way = ways.late(TOO_LATE_S)
            name = f"in step {first}"
            yield Case("policy late", name, "policy", "propose", way, first, 1, gate, timed=True)


def _gate() -> Iterator[Case]:
    for name, way, first, gate in _spread(ways.RAISING):
        yield Case("gate raises", name, "gate", "decide", way, first, 2, gate)
        yield Case("gate cannot begin", name, "gate", "reset", way, 0, 1, gate)
    for name, make, first, gate in _spread(ways.NO_DECISIONS):
        way = ways.answering(make)
        yield Case("gate answers rubbish", name, "gate", "decide", way, first, 3, gate)
    for first in (1, 4):
        way = ways.late(TOO_LATE_S)
        name = f"in step {first}"
        yield Case("gate late", name, "gate", "decide", way, first, 1, "policy alone", timed=True)


def _expert() -> Iterator[Case]:
    for name, way, first, _ in _spread(ways.RAISING):
        acting = partial(Case, part="expert", method="act", way=way, first=first)
        yield acting("expert raises, acting", name, gate="expert", ends=True)
        yield acting("expert raises, asked for a label", name, gate="policy, labelled")
        yield Case("expert cannot begin", name, "expert", "reset", way, 0, 1, "policy, labelled")
    for name, make, first, _ in _spread(ways.NO_ACTIONS):
        way = ways.answering(make)
        answering = partial(Case, part="expert", method="act", way=way, first=first)
        yield answering("expert answers rubbish, acting", name, gate="expert", ends=True)
        yield answering("expert answers rubbish, asked for a label", name, gate="policy, labelled")
    way = ways.late(TOO_LATE_S)
    yield Case("expert late", "in step 2", "expert", "act", way, 2, 1, "expert", timed=True)


def _environment() -> Iterator[Case]:
    failing = partial(Case, part="environment", ends=True)
    for name, way, first, gate in _spread({**ways.RAISING, "afterwards": ways.afterwards}):
        yield failing("environment raises in a step", name, method="step", way=way, first=first)
        yield failing(
            "environment raises at the end", name, method="metrics", way=way, times=9, gate=gate
        )
    for method in ("state", "outcome", "reset"):
        for name, way, first, gate in _spread(dict(list(ways.RAISING.items())[:7])):
            kind = "environment raises elsewhere"
            at = first if method == "state" else 0
            yield failing(kind, f"{method}: {name}", method=method, way=way, first=at, gate=gate)
    for kind, method, twists in (
        ("environment answers rubbish", "step", ways.NO_TRANSITIONS),
        ("environment shows rubbish at first", "reset", ways.NO_OBSERVATIONS),
        ("environment's state is rubbish", "state", ways.NO_STATES),
    ):
        for name, twist, first, gate in _spread(twists):
            at = 0 if method == "reset" else first + (method == "state")
            way = ways.twisted(twist)
            yield failing(kind, name, method=method, way=way, first=at, gate=gate)
    for method, answers in (("metrics", ways.NO_METRICS), ("outcome", ways.NO_OUTCOMES)):
        for name, make, _, gate in _spread(answers):
            yield failing(
                "environment's figures are rubbish",
                f"{method}: {name}",
                method=method,
                way=ways.answering(make),
                times=9,
                gate=gate,
            )


def _listener() -> Iterator[Case]:
    for place, (name, way) in enumerate(ways.RAISING.items()):
        method = ("on_start", "on_step", "on_end")[place % 3]
        yield Case("listener raises", f"{method}: {name}", "listener", method, way)


def _hanging() -> Iterator[Case]:
    hanging = partial(Case, timed=True)
    for name, way in ways.HANGING.items():
        yield hanging("policy hangs", name, "policy", "propose", way, 3, 99, "support")
        yield hanging("gate hangs", name, "gate", "decide", way, 2, 99, "policy alone")
        yield hanging("expert hangs", name, "expert", "act", way, 4, 99, "expert", ends=True)
        yield hanging("environment hangs", name, "environment", "step", way, 5, ends=True)
        yield hanging("listener hangs", name, "listener", "on_step", way, 1)


def _kept() -> Iterator[Case]:
    for gate in GATES:
        kept = partial(Case, "somebody changes what is kept", gate=gate, silent=True)
        yield kept("environment with one buffer", "environment", other=OneBuffer)
        yield kept("expert with one buffer", "expert", other=OneActionExpert)
        if gate != "expert":
            yield kept("policy with one buffer", "policy", other=lambda _: OneActionBuffer())
            yield kept("policy that scribbles", "policy", other=lambda _: Scribbling())
            # What it tries is refused, and told: it fails in that.
            yield Case(
                "somebody changes what is kept",
                "gate that meddles",
                "gate",
                gate=gate,
                other=Meddling,
            )
        yield Case(
            "somebody changes what is kept",
            "listener that scribbles",
            "listener",
            gate=gate,
            other=lambda _: ScribblingListener(),
        )
