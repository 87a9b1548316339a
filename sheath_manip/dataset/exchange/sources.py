"""Other people's data in one line: `import_data("lerobot:DIRECTORY", "runs/store")`."""

from collections.abc import Mapping
from pathlib import Path

from sheath_manip.dataset.exchange.apart import import_apart
from sheath_manip.dataset.exchange.formats import FORMATS
from sheath_manip.dataset.exchange.importing import NOTHING_TOLD, Imported, Origin
from sheath_manip.dataset.exchange.key_map import KeyMap
from sheath_manip.dataset.header import LEAST_RATE_HZ, MOST_RATE_HZ, is_rate
from sheath_manip.exceptions import ParameterError
from sheath_manip.types import EpisodeInfo, Outcome, Purpose


def import_data(
    source: str,
    store: Path | str,
    *,
    task: str = "",
    control_rate_hz: float | None = None,
    keys: Mapping[str, str] | None = None,
    outcome: Outcome | None = None,
    method: str = "",
    mask: str = "",
) -> Imported:
    """Take in the episodes of another tool's file, all or none, and return how many came.

    The file is read in a process of its own, which it may bring down. What `sheath data export`
    wrote comes back as it was, whatever else is told here.

    Args:
        source: `FORMAT:PATH`, such as `lerobot:DIRECTORY`, `robomimic:demo.hdf5` or, for a data set
            that Minari has downloaded, `minari:D4RL/door/human-v2`.
        store: directory for the episodes; made where there is none.
        task: name of the task; as the file says where empty.
        control_rate_hz: control steps a second; as the file says where None.
        keys: what the file's keys mean, such as `{"features": "obs/object,obs/eef_pos"}`; the
            format's own where a key is not given.
        outcome: how all episodes ended; None: as the file says, success where it does not.
        method: name of the method that recorded them; the file's name where empty.
        mask: the file's list of the episodes to take, such as robomimic's `train`; all where empty.

    Raises:
        ParameterError: task or control rate are told neither here nor by the file, or are others.
        StoreError: the file is damaged, or an episode does not fit; nothing is imported then.
        SetupError: a package that the format wants is not installed.
    """
    form, path = split_source(source)
    words = [f"{ours}={theirs}" for ours, theirs in (keys or {}).items()]
    named = method or named_after(path)
    told = origin(
        task, control_rate_hz, KeyMap.parse(words), outcome=outcome, method=named, mask=mask
    )
    return import_apart(form, path, Path(store), told)


def split_source(source: str) -> tuple[str, Path]:
    """Return format and path of `FORMAT:PATH`; raises ParameterError for anything else."""
    form, _, path = source.partition(":")
    if form not in FORMATS or not path:
        listed = ", ".join(f"{name}:PATH" for name in FORMATS)
        raise ParameterError(f"{source!r} is no FORMAT:PATH; wanted one of {listed}")
    return form, Path(path)


def named_after(path: Path) -> str:
    """Return the name of the method that recorded a file of which nothing is known but its name."""
    return path.name.partition(".")[0] or NOTHING_TOLD.info.method


def origin(
    task: str,
    control_rate_hz: float | None,
    keys: KeyMap,
    *,
    outcome: Outcome | None,
    method: str,
    mask: str,
) -> Origin:
    """Return what is told of a file's episodes; raises ParameterError for no control rate."""
    if control_rate_hz is not None and not is_rate(control_rate_hz):
        raise ParameterError(
            f"control rate {control_rate_hz} Hz; wanted {LEAST_RATE_HZ:g} .. {MOST_RATE_HZ:g}"
        )
    info = EpisodeInfo(
        task=task,
        seed=0,
        purpose=Purpose.DEMONSTRATION,
        control_rate_hz=control_rate_hz or 0.0,
        method=method,
        # Another tool knows none.
        variant="",
    )
    return Origin(info, outcome, keys, mask)
