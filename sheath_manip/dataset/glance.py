"""What a store tells of an episode at a glance, without its arrays, and that as a line of JSON."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from sheath_manip.dataset.compatibility import RecordedSpec
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.marks import Marks
from sheath_manip.dataset.space import Space
from sheath_manip.files.json_files import strict_float
from sheath_manip.types import EpisodeInfo, Outcome, Purpose


@dataclass(frozen=True)
class EpisodeSummary:
    """A stored episode at a glance, without its arrays."""

    name: str
    info: EpisodeInfo
    length: int
    """T, in control steps"""
    outcome: Outcome
    """what a person marked it as, else as recorded"""
    recorded_outcome: Outcome
    bad_steps: int
    """marked as not to be learned from"""
    expert_share: float
    """0..1 of the steps in which the expert acted"""
    queries: int
    """steps in which the gate asked for a label"""
    metrics: Mapping[str, float]
    bytes: int
    """on the disk"""
    spec: RecordedSpec
    """what another must have in common with it to be mixed with it"""

    @classmethod
    def of(cls, name: str, header: Header, bytes: int) -> "EpisodeSummary":
        """Return that of an episode which nobody has marked."""
        return cls(
            name=name,
            info=header.info,
            length=header.length,
            outcome=header.outcome,
            recorded_outcome=header.outcome,
            bad_steps=0,
            expert_share=header.expert_steps / header.length,
            queries=header.queries,
            metrics=header.metrics,
            bytes=bytes,
            spec=RecordedSpec.of(header),
        )

    def marked(self, marks: Marks) -> "EpisodeSummary":
        """Return it with what a person said of the episode afterwards."""
        if marks == Marks():
            return self
        outcome = marks.outcome or self.recorded_outcome
        return replace(self, outcome=outcome, bad_steps=marks.bad_steps(self.length))


def spec_to_json(spec: RecordedSpec) -> dict[str, Any]:
    """Return what many episodes have in common as strict JSON; `spec_from_json` is the inverse."""
    return {
        "task": spec.task,
        "control_rate_hz": float(spec.control_rate_hz),
        "cameras": {name: list(size) for name, size in spec.cameras.items()},
        "feature_size": spec.feature_size,
        "action_size": spec.action_size,
        "space": None if spec.space is None else spec.space.to_json(),
    }


def spec_from_json(told: Mapping[str, Any]) -> RecordedSpec:
    """Return the spec; raises whatever Python does for what is none."""
    return RecordedSpec(
        told["task"],
        float(told["control_rate_hz"]),
        {name: (int(height), int(width)) for name, (height, width) in told["cameras"].items()},
        int(told["feature_size"]),
        int(told["action_size"]),
        None if told["space"] is None else Space.from_json(told["space"]),
    )


def summary_to_json(summary: EpisodeSummary) -> list[Any]:
    """Return what an unmarked episode has for itself; `summary_from_json` is the inverse."""
    info = summary.info
    return [
        int(info.seed),
        str(info.purpose),
        info.method,
        int(info.round),
        int(info.index),
        int(info.run_seed),
        info.checkpoint,
        info.variant,
        info.session,
        summary.length,
        str(summary.recorded_outcome),
        summary.expert_share,
        summary.queries,
        {name: strict_float(value) for name, value in summary.metrics.items()},
        summary.bytes,
    ]


def summary_from_json(name: str, spec: RecordedSpec, told: list[Any]) -> EpisodeSummary:
    """Return the summary of an episode; raises ValueError or TypeError for what is none."""
    seed, purpose, method, number, index, run_seed, checkpoint, variant, session, *rest = told
    length, outcome, expert_share, queries, metrics, bytes = rest
    ended = _OUTCOMES[outcome]
    return EpisodeSummary(
        name,
        EpisodeInfo(
            spec.task,
            seed,
            _PURPOSES[purpose],
            spec.control_rate_hz,
            method,
            number,
            index,
            run_seed,
            checkpoint,
            variant,
            session,
        ),
        length,
        ended,
        ended,
        0,
        expert_share,
        queries,
        {metric: float(value) for metric, value in metrics.items()},
        bytes,
        spec,
    )


# A member looked up here takes a tenth of the time that the enumeration takes.
_OUTCOMES = {str(outcome): outcome for outcome in Outcome}
_PURPOSES = {str(purpose): purpose for purpose in Purpose}
