"""A data card: what a stranger must know of a store before using it, as markdown."""

from collections import Counter
from collections.abc import Iterable, Sequence
from statistics import mean

from sheath_manip.dataset.compatibility import RecordedSpec, differences
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.layout import LIMITED, SIGNALS, ArraySpec, layout
from sheath_manip.dataset.reader import EpisodeReader, EpisodeSummary
from sheath_manip.dataset.space import Space
from sheath_manip.dataset.table import readable
from sheath_manip.exceptions import StoreError
from sheath_manip.metrics import endings_line
from sheath_manip.types import TaskSpec

_MEANINGS = {
    "features": "what is measured",
    "time_s": "s, since the episode began",
    "state": "simulator state, for replay",
    "proposed": "by the policy; NaN where `has_proposed` is false",
    "labelled": "by the expert; NaN where `has_labelled` is false",
    "executed": "what was commanded, after the command filter where there is one",
    "has_proposed": "the policy proposed an action",
    "has_labelled": "the expert was asked",
    "intervention": "somebody else than the policy acts, though there was one",
    "query": "the gate asked for a label",
    "actor": "who acts: place in the attribute `actors`",
    "reason": "why: place in the attribute `reasons`",
    "score": "the signal's, the higher the safer; NaN where there is none",
    "threshold": "the score below which the expert takes over; NaN where there is none",
    "reward": "of the executed action",
    "limited": "by how much each limit (attribute `limits`) changed the command, as a share of the "
    "fastest one; NaN where it did not",
    "signals": "what the score is made of: the score of each signal (attribute `signals`), and the "
    "share of held-out expert steps that score lower; NaN where it has none",
}


def card(reader: EpisodeReader, spec: TaskSpec | None, licence: str) -> str:
    """The card of a store, in which what differs between its episodes is named.

    `spec` names features and actions where no episode does. Raises StoreError where no episode can
    be read.
    """
    summaries, broken = readable(reader)
    if not summaries:
        why = f" that can be read; {broken[0]}" if broken else ""
        raise StoreError(f"{reader.address} has no episode{why}")
    headers = [reader.header(summary.name) for summary in summaries]
    # Only where a limit acted, or a gate judged, does an episode have the array that tells of it.
    header = max(headers, key=lambda h: (h.space is not None, bool(h.limits), bool(h.signals)))
    space = header.space or (None if spec is None else Space.of(spec))
    info = header.info
    dates = sorted({header.recorded_utc for header in headers})
    steps = sum(summary.length for summary in summaries)
    minutes = sum(each.length / each.info.control_rate_hz for each in summaries) / 60
    expert = sum(summary.expert_share * summary.length for summary in summaries) / steps
    versions = ", ".join(f"{package} {version}" for package, version in header.versions.items())
    lines = [
        f"# Episodes of the task {info.task}",
        "",
        f"- licence: {licence}",
        f"- control rate: {_each(f'{s.info.control_rate_hz:g} Hz' for s in summaries)}",
        f"- variant: {_each(s.info.variant or 'not recorded' for s in summaries)}",
        f"- {len(summaries)} episodes, {steps} steps, {minutes:.1f} min, "
        f"{sum(summary.bytes for summary in summaries) / 1e6:.1f} MB",
        f"- outcomes: {endings_line(s.outcome for s in summaries)}",
        f"- purposes: {_counts(str(s.info.purpose) for s in summaries)}",
        f"- methods: {_counts(s.info.method or 'none' for s in summaries)}",
        f"- the expert acted in {expert:.1%} of the steps; "
        f"{sum(s.queries for s in summaries)} steps asked for a label",
        *(f"- {name}: mean {value:.4g}" for name, value in _metrics(summaries).items()),
        f"- recorded {' to '.join(dict.fromkeys([dates[0], dates[-1]]))} by {versions}",
        *_unlike(summaries, RecordedSpec.of(header)),
        *([f"- {len(broken)} further episodes cannot be read"] if broken else []),
        "",
        "Each episode has T steps and T+1 observations (`final/…` is the last), all actions and "
        "why each was done, and whether it terminated or was truncated.",
        "",
        "| key | type | shape | meaning |",
        "|---|---|---|---|",
        *(_row(array, header, space) for array in layout(header)),
        "",
    ]
    return "\n".join(lines)


def _each(words: Iterable[str]) -> str:
    """The one word that all have, or how many have which."""
    counts = Counter(words)
    return next(iter(counts)) if len(counts) == 1 else _counts(counts.elements())


def _unlike(summaries: Sequence[EpisodeSummary], described: RecordedSpec) -> list[str]:
    """Lines on episodes that are not as the one whose arrays the card describes."""
    unlike = {s.name: differences(described, s.spec) for s in summaries}
    counts = Counter("; ".join(map(str, found)) for found in unlike.values() if found)
    return [f"- {count} episodes have another: {what}" for what, count in counts.most_common()]


def _row(array: ArraySpec, header: Header, space: Space | None) -> str:
    final = array.path.startswith("final/")
    sizes = {LIMITED: ["l"], SIGNALS: ["k", 2]}.get(array.path, array.shape[1:])
    shape = ", ".join(map(str, array.shape if final else ("T", *sizes)))
    return f"| `{array.path}` | {array.dtype} | ({shape}) | {_meaning(array, header, space)} |"


def _meaning(array: ArraySpec, header: Header, space: Space | None) -> str:
    paths = {each.path for each in layout(header)}
    path = array.path.removeprefix("final/")
    text = "RGB" if array.is_image else _MEANINGS[path]
    if path != array.path:
        text += ", after the last action"
    elif f"final/{path}" in paths:
        text += ", before the action"
    names: Sequence[str] = ()
    if space is not None and path == "features" and len(space.feature_names) == header.feature_size:
        names = space.feature_names
    if space is not None and path in ("proposed", "labelled", "executed"):
        names = space.action_names
    # A platform of hundreds of tiles would make a line that nobody reads.
    listed = ", ".join(f"`{name}`" for name in names[:16]) + ", …" * (len(names) > 16)
    return text + (f": {listed}" if listed else "")


def _counts(words: Iterable[str]) -> str:
    return ", ".join(f"{n} {word}" for word, n in Counter(words).most_common())


def _metrics(summaries: Sequence[EpisodeSummary]) -> dict[str, float]:
    names = {name: None for summary in summaries for name in summary.metrics}
    return {name: mean(s.metrics[name] for s in summaries if name in s.metrics) for name in names}
