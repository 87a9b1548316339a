"""`sheath data show`: one episode on the terminal."""

import math

import numpy as np
from rich.console import Console
from rich.table import Table
from rich.text import Text

from sheath_manip.dataset.exchange.selection import runs
from sheath_manip.dataset.header import Header
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.locations import open_store
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.exceptions import StoreError

LISTED_INTERVENTIONS = 12


def print_show(address: str, episode: str, console: Console) -> int:
    """Print where an episode comes from, how it went, and its arrays.

    Raises StoreError where `address` is no store, where it has no `episode` (a name, or a place in
    the list from 0), and where that is damaged.
    """
    reader = open_store(address)
    name = chosen(reader, episode)
    header, recorded = reader.header(name), reader.recorded(name, need_images=False)
    marks = reader.marks(name)
    console.print(Text(name, style="bold"))
    facts = Table(box=None, show_header=False, pad_edge=False)
    for what, text in _facts(header, sum(reader.files(name).values())).items():
        facts.add_row(what, Text(text))
    spans = [f"{a} .. {b - 1}" for a, b in runs(recorded.arrays["intervention"])]
    more = f" and {len(spans) - LISTED_INTERVENTIONS} more" * (len(spans) > LISTED_INTERVENTIONS)
    if marks.outcome is not None:
        facts.add_row("marked as", Text(marks.outcome))
    for each in marks.notes:
        facts.add_row(f"note at {each.step}", Text(each.text))
    if marks.bad:
        facts.add_row("marked bad", ", ".join(f"{a} .. {b - 1}" for a, b in marks.bad))
    facts.add_row("interventions", ", ".join(spans[:LISTED_INTERVENTIONS]) + more or "none")
    console.print(facts)
    table = Table(box=None, pad_edge=False)
    for heading in ("array", "type", "shape", "range"):
        table.add_column(heading)
    for spec in layout(header):
        values = recorded.arrays.get(spec.path)
        cells = (spec.path, spec.dtype, str(spec.shape), "" if values is None else _range(values))
        table.add_row(*map(Text, cells))
    console.print(table)
    return 0


def chosen(reader: EpisodeReader, wanted: str) -> str:
    """The name of the episode that `wanted` names or counts; raises StoreError."""
    names = reader.names()
    if wanted in names:
        return wanted
    try:
        return names[int(wanted)]
    except (ValueError, IndexError):
        raise StoreError(
            f"{reader.address} has no episode {wanted!r}; wanted a name of `sheath data list`, or "
            f"a number below {len(names)}"
        ) from None


def _facts(header: Header, bytes: int) -> dict[str, str]:
    info = header.info
    ends = [word for word in ("terminated", "truncated") if getattr(header, word)]
    seconds = header.length / info.control_rate_hz
    return {
        "task": info.task,
        "variant": info.variant or "not recorded",
        "purpose": info.purpose,
        "method": info.method or "none",
        "round, index": f"{info.round}, {info.index}",
        "scene seed, run seed": f"{info.seed}, {info.run_seed}",
        "checkpoint": info.checkpoint or "none",
        "session": info.session or "none",
        "length": f"{header.length} steps at {info.control_rate_hz:g} Hz, {seconds:.1f} s",
        "outcome": f"{header.outcome} ({' and '.join(ends) or 'neither terminated nor truncated'})",
        "expert, queries": f"{header.expert_steps} and {header.queries} steps",
        "metrics": ", ".join(f"{k} {v:.4g}" for k, v in header.metrics.items()) or "none",
        "size": f"{bytes / 1e6:.2f} MB",
        "recorded": f"{header.recorded_utc} by "
        + ", ".join(f"{package} {version}" for package, version in header.versions.items()),
    }


def _range(values: np.ndarray) -> str:
    known = values[np.isfinite(values)] if values.dtype.kind == "f" else values
    if not known.size:
        return "" if not values.size else "no finite value"
    missing = math.prod(values.shape) - known.size
    return f"{known.min():.4g} .. {known.max():.4g}" + f", {missing} not finite" * bool(missing)
