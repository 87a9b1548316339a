"""Episodes of anybody's, wherever they lie and in whatever format they are."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from sheath_manip.dataset.exchange.apart import import_apart
from sheath_manip.dataset.exchange.formats import FORMATS
from sheath_manip.dataset.exchange.importing import NOTHING_TOLD, Origin
from sheath_manip.dataset.exchange.key_map import KeyMap
from sheath_manip.dataset.header import LEAST_RATE_HZ, MOST_RATE_HZ, is_rate
from sheath_manip.dataset.locations import open_store
from sheath_manip.dataset.reader import EpisodeReader
from sheath_manip.exceptions import ParameterError


@contextmanager
def episodes_of(source: str, origin: Origin = NOTHING_TOLD) -> Iterator[EpisodeReader]:
    """Give the episodes of `source` to read; those of other tools' files until the end of the with.

    Args:
        source: a store, directory or URL; or another tool's data as `FORMAT:PATH`, such as
            `lerobot:DIR`, `minari:ID`, `robomimic:demo.hdf5`. That is imported into a temporary
            store, all of it or nothing.
        origin: what such a file does not tell itself.

    Raises what opening a store and importing raise: StoreError, ParameterError, SetupError.
    """
    format, colon, path = source.partition(":")
    if not (colon and format in FORMATS):
        yield open_store(source)
        return
    with tempfile.TemporaryDirectory(prefix="sheath-import-") as folder:
        store = Path(folder) / "store"
        import_apart(format, Path(path), store, origin)
        yield open_store(str(store))


def told_origin(
    task: str = "", control_rate_hz: float | None = None, keys: tuple[str, ...] = ()
) -> Origin:
    """Return what a person tells of another tool's file; raises ParameterError.

    Args:
        task: its name; empty where the file says it.
        control_rate_hz: control steps a second; None where the file says it.
        keys: what its keys mean, such as `features=state`.
    """
    rate_hz = 0.0 if control_rate_hz is None else control_rate_hz
    if control_rate_hz is not None and not is_rate(rate_hz):
        raise ParameterError(
            f"control rate {rate_hz} Hz; wanted {LEAST_RATE_HZ:g} .. {MOST_RATE_HZ:g}"
        )
    info = replace(NOTHING_TOLD.info, task=task, control_rate_hz=rate_hz)
    return replace(NOTHING_TOLD, info=info, keys=KeyMap.parse(keys))
