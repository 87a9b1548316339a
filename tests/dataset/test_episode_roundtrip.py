import tempfile

import numpy as np
from hypothesis import given

from sheath_manip.dataset.attributes import parse_header, to_attributes
from sheath_manip.dataset.check import check
from sheath_manip.dataset.header import header_of
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.recorded import Frames
from sheath_manip.dataset.rows import episode_from
from sheath_manip.dataset.steps import arrays_of
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.dataset.zarr_files import group_file
from sheath_manip.types import Episode
from sheath_manip.types.columns import Columns
from tests.cases import cases
from tests.dataset.generated import episodes
from tools.identical import identical


@cases(30)
@given(episodes())
def test_header_and_arrays_hold_all_of_an_episode(episode: Episode) -> None:
    header = header_of(episode)
    read = parse_header(episode_name(episode.info), group_file(to_attributes(header)))
    arrays = {
        path: rows[(slice(None),)] if isinstance(rows, Frames) else rows
        for path, rows in arrays_of(episode, header).items()
    }
    again = episode_from(read, arrays)
    assert identical(again, episode)
    # What is read by column is what its steps are, one by one.
    made = Columns.of(again.steps, driven=bool(episode.info.checkpoint))
    for name, column in vars(made).items():
        found = getattr(again.columns, name)
        if name == "signals":
            assert list(found) == list(column)
            assert all(np.array_equal(found[each], column[each], equal_nan=True) for each in found)
        else:
            assert found.dtype == column.dtype, name
            np.testing.assert_array_equal(found, column, err_msg=name)


@cases(6)
@given(episodes())
def test_an_episode_comes_back_from_the_disk_to_the_bit(episode: Episode) -> None:
    with tempfile.TemporaryDirectory() as folder:
        store = EpisodeStore.create(folder)
        assert not store.has(episode.info)
        name = store.append(episode)
        assert store.has(episode.info)
        assert store.names() == [name]
        assert identical(store.read(name), episode)
        # A feature that is no number is remarked on, and nothing more.
        assert not [fault for fault in check(store) if fault.damaging]


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
