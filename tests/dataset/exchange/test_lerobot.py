"""LeRobot's data sets: as its own library wrote them, and spoiled."""

import io
import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from PIL import Image

from sheath_manip.dataset.attributes import to_attributes
from sheath_manip.dataset.check import check
from sheath_manip.dataset.exchange.formats import open_file
from sheath_manip.dataset.exchange.importing import NOTHING_TOLD, Imported, import_episodes
from sheath_manip.dataset.exchange.key_map import KeyMap
from sheath_manip.dataset.exchange.lerobot import HEADERS
from sheath_manip.dataset.exchange.lerobot_columns import columns_of, features
from sheath_manip.dataset.exchange.lerobot_index import _filled
from sheath_manip.dataset.exchange.selection import ActionChoice
from sheath_manip.dataset.layout import layout
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, StoreError
from sheath_manip.types import Actor, Outcome, Purpose
from tests.episodes import episode_of
from tools.foreign_writers import require_small_set
from tools.readers.small_set import TASKS, episode

SETS = Path(__file__).parent / "sets"
VERSIONS = ("v2.1", "v3.0")
CUBES = replace(NOTHING_TOLD, info=replace(NOTHING_TOLD.info, task="cubes"))
FILM = "observation.images.film"


@pytest.fixture(params=VERSIONS)
def cubes(request, tmp_path: Path) -> Path:
    """A copy to spoil."""
    return Path(shutil.copytree(SETS / f"lerobot-{request.param}", tmp_path / "cubes"))


def taken_in(path: Path, store: EpisodeStore, *keys: str) -> Imported:
    told = replace(CUBES, keys=KeyMap.parse(keys))
    return import_episodes(open_file("lerobot", path), store, told)


def tables(path: Path) -> list[Path]:
    return sorted(path.glob("data/*/*.parquet"))


def change(file: Path, column: str, values: pa.Array) -> None:
    table = pq.read_table(file)
    pq.write_table(table.set_column(table.column_names.index(column), column, values), file)


def say(path: Path, **changes: object) -> None:
    file = path / "meta" / "info.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | changes))


def test_it_comes_in_as_lerobot_wrote_it(cubes, store) -> None:
    done = taken_in(cubes, store)
    assert require_small_set(store) > 0
    assert check(store) == []
    assert "images/film=observation.images.film" in done.remarks[0]
    assert "outcome=next.success" in done.remarks[0]
    first = store.read(store.names()[0])
    assert (first.info.variant, first.info.control_rate_hz) == (TASKS[0], 10.0)
    assert (first.terminated, first.truncated) == (True, False)


def test_what_a_person_did_is_labelled_and_nothing_else(cubes, store) -> None:
    taken_in(cubes, store)
    first = store.read(store.names()[0])
    assert first.info.purpose is Purpose.LEARNING
    by_person = episode(0)["intervention"]
    assert [step.label is not None for step in first.steps] == by_person.tolist()
    actors = [step.decision.actor for step in first.steps]
    assert actors == [Actor.EXPERT if each else Actor.POLICY for each in by_person]
    assert first.columns.intervention.tolist() == by_person.tolist()


def test_entries_of_a_vector_have_names(cubes, store) -> None:
    taken_in(cubes, store, "features=observation.state/gripper_m,observation.state/elbow_rad")
    held = store.recorded(store.names()[0]).arrays["features"]
    assert np.array_equal(held, episode(0)["state"][:, [2, 1]])
    with pytest.raises(StoreError, match=r"no key 'observation.state/wrist' for features"):
        taken_in(cubes, store, "features=observation.state/wrist")


def test_several_tasks_want_one_name(cubes, store) -> None:
    with pytest.raises(ParameterError, match="does not tell one task; give --task"):
        import_episodes(open_file("lerobot", cubes), store, None)
    wrong = replace(CUBES, info=replace(CUBES.info, control_rate_hz=30.0))
    with pytest.raises(ParameterError, match=r"recorded at 10 Hz, not at 30 Hz"):
        import_episodes(open_file("lerobot", cubes), store, wrong)


def test_a_fault_in_one_episode_leaves_none_and_names_it(cubes, store) -> None:
    before = sorted(entry.name for entry in store.path.iterdir())
    table = tables(cubes)[-1]
    numbers = pq.read_table(table).column("frame_index").to_pylist()
    change(table, "frame_index", pa.array([*numbers[:-1], 99]))
    with pytest.raises(StoreError, match=r"nothing is imported: episode 2 .*frame_index"):
        taken_in(cubes, store)
    assert sorted(entry.name for entry in store.path.iterdir()) == before


def test_a_film_that_lacks_a_frame_or_is_none(cubes, store) -> None:
    films = sorted(cubes.glob("videos/**/*.mp4"))
    info = json.loads((cubes / "meta" / "info.json").read_text())
    say(cubes, fps=5)
    with pytest.raises(StoreError, match=r"lacks .* of the [45] frames"):
        taken_in(cubes, store)
    say(cubes, fps=10)
    info["features"][FILM]["shape"] = [64, 32, 3]
    say(cubes, features=info["features"])
    with pytest.raises(StoreError, match=r"of 64x64 pixels; wanted 64x32"):
        taken_in(cubes, store)
    # What FFmpeg would follow to wherever it leads.
    films[0].write_text("#EXTM3U\n#EXTINF:1,\nhttp://127.0.0.1:9/secret.ts\n")
    with pytest.raises(StoreError, match="does not decode"):
        taken_in(cubes, store)
    assert store.names() == []


def test_nothing_outside_is_read(cubes, tmp_path) -> None:
    shutil.copy(tables(cubes)[0], tmp_path / "secret.parquet")
    for template in (
        "../secret.parquet",
        str(tmp_path / "secret.parquet"),
        "{episode_chunk.__class__}",
        "{0!r:>999999999}",
    ):
        say(cubes, data_path=template)
        with pytest.raises(StoreError, match="that is not here"):
            open_file("lerobot", cubes)
    say(cubes, data_path="data/{moon:03d}.parquet")
    with pytest.raises(StoreError, match="wanted fields of"):
        open_file("lerobot", cubes)


def test_templates_are_filled_in_by_hand() -> None:
    values = {"episode_index": 7, "video_key": "a.b"}
    assert _filled("x/{video_key}/{episode_index:06d}.mp4", values) == "x/a.b/000007.mp4"
    assert _filled("{episode_index}", values) == "7"


def test_images_beside_the_table_must_be_of_the_directory(cubes, tmp_path) -> None:
    small = "observation.images.small"
    images = pq.read_table(tables(cubes)[0]).column(small).to_pylist()
    for number, image in enumerate(images):
        (cubes / f"{number}.png").write_bytes(image["bytes"])
        (tmp_path / f"{number}.png").write_bytes(image["bytes"])
    for folder, comes_in in (("", True), ("../", False), (f"{tmp_path}/", False)):
        paths = [{"bytes": None, "path": f"{folder}{n}.png"} for n in range(len(images))]
        change(tables(cubes)[0], small, pa.array(paths))
        file = open_file("lerobot", cubes)
        track = next(file.tracks())
        if comes_in:
            assert np.array_equal(track.read(small), episode(0)["small"])
        else:
            with pytest.raises(StoreError, match="no file of"):
                track.read(small)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"codebase_version": "v1.6"}, r"format 'v1.6'; wanted v2.0, v2.1, v3.0"),
        ({"features": None}, "does not decode"),
        ({"fps": 0}, "control rate of 0 Hz"),
        ({"features": {"action": {"dtype": "float32", "shape": [10**12]}}}, "whole number"),
    ],
)
def test_an_index_that_cannot_be(cubes, store, changes, message) -> None:
    say(cubes, **changes)
    with pytest.raises(StoreError, match=message):
        taken_in(cubes, store)


def test_numbers_that_are_none(cubes, store) -> None:
    table = tables(cubes)[0]
    length = pq.read_table(table).num_rows
    for values, message in (
        (pa.array([[1.0, 2.0], *[[1.0]] * (length - 1)]), "several lengths"),
        (pa.array([[1.0, None]] * length), "without a value"),
        (pa.array([["a", "b"]] * length), "wanted booleans or numbers"),
        (pa.array([[1.0] * 3] * length), r"has 12 numbers; wanted 4 of \(2,\)"),
    ):
        change(table, "action", values)
        with pytest.raises(StoreError, match=message):
            taken_in(cubes, store)


def test_ours_comes_back_but_for_what_has_no_place_there(store, tmp_path) -> None:
    store.append(episode_of("pepp", side_px=4))
    recorded = store.recorded(store.names()[0])
    (tmp_path / "ours" / "meta" / "episodes").mkdir(parents=True)
    written = columns_of(recorded, ActionChoice.EXECUTED)
    told = features(recorded, ActionChoice.EXECUTED)
    length = recorded.header.length
    columns = {
        name: pa.array([{"bytes": png(image), "path": None} for image in values])
        if values.ndim == 4
        else pa.array(values.tolist(), pa.list_(pa.from_numpy_dtype(values.dtype)))
        for name, values in written.items()
    }
    columns |= {"episode_index": pa.array([0] * length), "frame_index": pa.array(range(length))}
    pq.write_table(pa.table(columns), tmp_path / "ours" / "data.parquet")
    row = {"episode_index": [0], "length": [length], "tasks": [["x"]]}
    row |= {"data/chunk_index": [0], "data/file_index": [0]}
    pq.write_table(pa.table(row), tmp_path / "ours" / "meta" / "episodes" / "0.parquet")
    info = {"codebase_version": "v3.0", "fps": 10, "features": told, "data_path": "data.parquet"}
    (tmp_path / "ours" / "meta" / "info.json").write_text(json.dumps(info))
    headers = json.dumps([to_attributes(recorded.header)])
    (tmp_path / "ours" / HEADERS).write_text(headers)
    back = EpisodeStore.create(tmp_path / "back")
    assert import_episodes(open_file("lerobot", tmp_path / "ours"), back, None).added == 1
    found = back.recorded(store.names()[0])
    for spec in layout(recorded.header):
        if not spec.path.startswith("final/"):
            assert found.arrays[spec.path].tobytes() == recorded.arrays[spec.path].tobytes(), spec
    assert found.header.outcome is Outcome.SUCCESS
    assert np.array_equal(found.arrays["final/features"], recorded.arrays["features"][-1])


def png(image: np.ndarray) -> bytes:

    out = io.BytesIO()
    Image.fromarray(image).save(out, "PNG")
    return out.getvalue()
