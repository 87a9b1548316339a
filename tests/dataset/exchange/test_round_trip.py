"""Export, import, export: the same files again, and the same episodes between."""

import tempfile
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given
from hypothesis import strategies as st

from sheath_manip.dataset.attributes import to_attributes
from sheath_manip.dataset.check import check
from sheath_manip.dataset.exchange.exporting import export
from sheath_manip.dataset.exchange.formats import open_file
from sheath_manip.dataset.exchange.importing import import_episodes
from sheath_manip.dataset.exchange.selection import ActionChoice, Selection
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.tasks.table import TASKS
from tests.cases import cases
from tests.dataset.generated import of_task
from tools.identical import identical

FORMATS = {
    "demos.zarr": "replay-buffer",
    "demos.zarr.zip": "replay-buffer",
    "demos.hdf5": "robomimic",
}


def bytes_of(path: Path) -> dict[str, bytes]:
    """Every file of what was exported."""
    if path.is_file():
        return {path.name: path.read_bytes()}
    files = (file for file in path.rglob("*") if file.is_file())
    return {file.relative_to(path).as_posix(): file.read_bytes() for file in files}


OTHERS = [pytest.param(name, marks=pytest.mark.soak) for name in TASKS if name != "driving"]
"""whose episodes have nothing that those of the toy or of driving have not"""


@pytest.mark.parametrize("target", FORMATS)
@pytest.mark.parametrize("task", ["corridor", "driving", *OTHERS])
@cases(
    3,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(seed=st.integers(0, 2**32))
def test_export_import_export_is_the_identity(specs, task, target, seed) -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        store = EpisodeStore.create(folder / "store")
        for episode in of_task(specs[task], seed):
            store.append(episode)
        first, second = folder / "first" / target, folder / "second" / target
        export(store, first, FORMATS[target], Selection())
        back = EpisodeStore.create(folder / "back")
        import_episodes(open_file(FORMATS[target], first), back, None)
        export(back, second, FORMATS[target], Selection())
        assert bytes_of(first) == bytes_of(second)
        assert back.names() == store.names()
        for episode in store.names():
            assert identical(back.read(episode), store.read(episode))
            assert to_attributes(back.header(episode)) == to_attributes(store.header(episode))
        assert check(back) == []


@pytest.mark.parametrize("target", ["demos.zarr", "demos.hdf5"])
def test_what_was_selected_comes_back_too(specs, tmp_path, target) -> None:
    store = EpisodeStore.create(tmp_path / "store")
    for episode in of_task(specs["corridor"], seed=5, count=8, longest=12):
        store.append(episode)
    selection = Selection(expert_steps=True, action=ActionChoice.LABELLED)
    form = FORMATS[target]
    done = export(store, tmp_path / "1" / target, form, selection)
    back = EpisodeStore.create(tmp_path / "back")
    import_episodes(open_file(form, tmp_path / "1" / target), back, None)
    assert len(back.names()) == done.episodes > 4
    # All that is left is by the expert and labelled, so that the same selection takes all of it.
    assert export(back, tmp_path / "2" / target, form, selection) == done
    assert bytes_of(tmp_path / "1" / target) == bytes_of(tmp_path / "2" / target)
