"""Episodes in an object store, on a server of the S3 protocol."""

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from itertools import count
from pathlib import Path

import obstore
import pytest
from obstore.store import from_url

from sheath_manip.dataset.check import check
from sheath_manip.dataset.exchange.exporting import export
from sheath_manip.dataset.exchange.selection import Selection
from sheath_manip.dataset.faults import FaultKind
from sheath_manip.dataset.layout import ArraySpec
from sheath_manip.dataset.locations import open_store
from sheath_manip.dataset.mapped import mapped_samples
from sheath_manip.dataset.marker import MARKER
from sheath_manip.dataset.merging import Merged, merge, split
from sheath_manip.dataset.remote import RemoteStore
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import StoreError
from sheath_manip.seeding import generator
from sheath_manip.types.samples import samples_from
from tests.s3 import BUCKET, s3_server
from tools.identical import identical
from tools.synthetic import synthetic_episode, synthetic_info

numbers = count()


@pytest.fixture(scope="module", autouse=True)
def server() -> Iterator[None]:
    with s3_server():
        yield


@pytest.fixture
def url() -> str:
    """Where nothing is yet."""
    return f"s3://{BUCKET}/demos-{next(numbers)}"


@pytest.fixture
def name(store: EpisodeStore) -> str:
    """The one episode of `store`, longer than a chunk of frames."""
    return store.append(synthetic_episode(synthetic_info(0, 0), length=65, pixels=4))


@pytest.fixture
def pushed(store: EpisodeStore, name: str, url: str) -> RemoteStore:
    """The URL, where `name` was pushed to."""
    assert store.names() == [name]
    target = RemoteStore.create(url)
    assert merge([store], target) == Merged(1, 0)
    return RemoteStore(url)


def test_what_was_pushed_is_read_in_place(pushed, store, name) -> None:
    assert pushed.names() == [name]
    assert identical(pushed.read(name), store.read(name))
    assert pushed.infos() == store.infos()
    assert pushed.header(name) == store.header(name)
    assert check(pushed) == []
    assert pushed.read(name, need_images=False).steps[0].observation.images == {}


def test_it_is_trained_on_and_exported_in_place(pushed, store, name, tmp_path: Path) -> None:
    mapped = mapped_samples(pushed, [name], tmp_path / "cache")
    assert mapped.labels.tobytes() == samples_from([store.read(name)]).labels.tobytes()
    for reader, target in ((pushed, "there.hdf5"), (store, "here.hdf5")):
        export(reader, tmp_path / target, "robomimic", Selection())
    assert (tmp_path / "there.hdf5").read_bytes() == (tmp_path / "here.hdf5").read_bytes()


def test_it_is_pulled_to_the_byte(pushed, store, name, tmp_path: Path) -> None:
    back = EpisodeStore.create(tmp_path / "back")
    assert merge([pushed], back) == Merged(1, 0)
    assert back.files(name) == store.files(name)
    assert all(back.content(name, f) == store.content(name, f) for f in store.files(name))
    split(pushed, {"all": 1.0}, tmp_path / "parts", generator("split", 0))
    assert EpisodeStore(tmp_path / "parts" / "all").names() == [name]


def test_what_is_there_is_not_pushed_again(pushed, store, monkeypatch) -> None:
    monkeypatch.setattr(obstore, "put", None)
    assert merge([store], pushed) == Merged(0, 1)


def test_another_episode_of_that_name_gets_a_new_one(pushed, store, name, tmp_path: Path) -> None:
    other = EpisodeStore.create(tmp_path / "other")
    episode = store.read(name)
    short = replace(episode, steps=episode.steps[:9])
    other.append(short)
    done = merge([other], pushed)
    (new,) = done.renamed
    assert pushed.names() == [name, new]
    assert identical(pushed.read(name), episode)
    info = pushed.header(new).info
    assert identical(pushed.read(new), replace(short, info=info))
    assert replace(info, session="") == episode.info
    assert check(pushed) == []
    # Again, and from there: all of it is known.
    assert merge([other], pushed) == Merged(0, 1)
    assert merge([pushed], other) == Merged(1, 1, tuple(other.names()[1:]))


def test_the_manifest_is_written_last(store, name, url, monkeypatch) -> None:
    written = []
    put = obstore.put

    def noted(objects, path, content):
        written.append(path)
        return put(objects, path, content)

    monkeypatch.setattr(obstore, "put", noted)
    merge([store], RemoteStore.create(url))
    assert written[0] == MARKER
    assert written[-1] == f"manifest/{name}.json"
    assert set(written[1:-1]) == {f"{name}/{file}" for file in store.files(name)}


def test_a_push_that_is_cut_off_shows_nothing_and_is_mended(store, name, url, monkeypatch) -> None:
    target, put = RemoteStore.create(url), obstore.put
    whole = len(store.files(name)) + 1
    for cut in (1, whole // 2, whole - 1):
        left = iter(range(cut))

        def until_cut(*arguments, left=left):
            if next(left, None) is None:
                raise KeyboardInterrupt
            return put(*arguments)

        monkeypatch.setattr(obstore, "put", until_cut)
        with pytest.raises(KeyboardInterrupt):
            merge([store], target)
        reader = RemoteStore(url)
        assert reader.names() == []
        assert [(f.name, f.kind) for f in check(reader)] == [(name, FaultKind.LEFTOVER)]
        with pytest.raises(StoreError, match="has no episode"):
            reader.read(name)
    monkeypatch.setattr(obstore, "put", put)
    merge([store], target)
    assert identical(RemoteStore(url).read(name), store.read(name))
    assert check(RemoteStore(url)) == []


def test_a_dropped_episode_leaves_its_neighbours(store, url) -> None:
    # The one name is the beginning of the other.
    seeds = [1, 12]
    names = [
        store.append(synthetic_episode(replace(synthetic_info(0, 0), seed=seed), 2, 2))
        for seed in seeds
    ]
    target = RemoteStore.create(url)
    merge([store], target)
    with pytest.raises(StoreError, match="has no episode"):
        target.drop("learning-noise-s0-r00-i000-seed2")
    target.drop(names[0])
    assert RemoteStore(url).names() == names[1:] == target.names()
    assert check(RemoteStore(url)) == []


def delete(path: str) -> Callable:
    return lambda objects, name: obstore.delete(objects, path.format(name))


def overwrite(path: str, content: bytes) -> Callable:
    return lambda objects, name: obstore.put(objects, path.format(name), content)


def manifest(**changes: object) -> Callable:
    def change(objects, name):
        path = f"manifest/{name}.json"
        content = json.loads(bytes(obstore.get(objects, path).bytes())) | changes
        obstore.put(objects, path, json.dumps(content).encode())

    return change


outside = {"../../x": {"bytes": 1, "sha256": "0" * 64}}
DAMAGES = {
    "a lost chunk": (delete("{}/executed/c.0.0"), "executed/c.0.0, which is not there"),
    "a lost array": (delete("{}/score/zarr.json"), "the array score is missing"),
    "a lost header": (delete("{}/zarr.json"), "its manifest is there, zarr.json is not"),
    "a broken header": (overwrite("{}/zarr.json", b"{"), "its zarr.json does not decode"),
    "another chunk": (
        overwrite("{}/executed/c.0.0", b"x"),
        "executed/c.0.0 differs from what was pushed",
    ),
    "a broken manifest": (overwrite("manifest/{}.json", b"{"), "its manifest is broken"),
    "a manifest of text": (overwrite("manifest/{}.json", b'"x"'), "its manifest is broken"),
    "another schema": (manifest(schema=2), "another format or schema"),
    "no sizes": (manifest(files={"zarr.json": {}}), "its manifest is broken"),
    "a path outside": (manifest(files=outside), "outside the episode"),
    "no files": (manifest(files=[]), "its manifest is broken"),
}


@pytest.mark.parametrize("what", DAMAGES)
def test_damage_is_named_in_one_line(pushed, name, what, tmp_path: Path) -> None:
    damage, message = DAMAGES[what]
    damage(from_url(pushed.url), name)
    reader = RemoteStore(pushed.url)
    assert [fault.name for fault in check(reader)] == [name]
    with pytest.raises(StoreError, match=message) as caught:
        reader.read(name)
    assert "\n" not in str(caught.value)
    target = EpisodeStore.create(tmp_path / "back")
    with pytest.raises(StoreError, match=name):
        merge([reader], target)
    assert target.names() == []
    reader.drop(name)
    assert check(reader) == []


def test_a_folder_file_that_no_array_needs_is_missed_too(pushed, name) -> None:
    obstore.delete(from_url(pushed.url), f"{name}/images/zarr.json")
    (fault,) = check(RemoteStore(pushed.url))
    assert fault.kind is FaultKind.MISSING
    assert "images/zarr.json, which is not there" in fault.text


def test_a_changed_object_is_not_pulled(pushed, name, tmp_path: Path) -> None:
    path = f"{name}/zarr.json"
    header = bytes(obstore.get(from_url(pushed.url), path).bytes())
    obstore.put(from_url(pushed.url), path, header.replace(b"0.1.0", b"0.1.1"))
    with pytest.raises(StoreError, match=r"its header is not as it was written"):
        merge([RemoteStore(pushed.url)], EpisodeStore.create(tmp_path / "back"))


@pytest.mark.parametrize(
    ("content", "message"),
    [(b"{", "does not decode"), (b"{}", "another format"), (None, "found no sheath-store.json")],
)
def test_no_store_is_one_line(url, content, message) -> None:
    if content is not None:
        obstore.put(from_url(url), MARKER, content)
    with pytest.raises(StoreError, match=message):
        RemoteStore(url)


@pytest.mark.parametrize("url", ["moon://x", "s3://", "http://127.0.0.1:1/x"])
def test_an_address_that_leads_nowhere_is_one_line(url) -> None:
    with pytest.raises(StoreError, match="cannot reach") as caught:
        open_store(url, create=True)
    assert "\n" not in str(caught.value)


def test_a_server_that_went_away_is_no_damage(store, name) -> None:
    with s3_server():
        target = RemoteStore.create(f"s3://{BUCKET}/demos")
        merge([store], target)
        target.header(name)
    for reach in (
        lambda: target.names(),
        lambda: target.header(name),
        lambda: target.read(name),
        lambda: check(target),
        lambda: merge([store], target),
        lambda: target.array(name, ArraySpec("score", (65,), "float64")),
        lambda: target.content(name, "zarr.json"),
    ):
        with pytest.raises(StoreError, match=r"cannot reach s3://.*AWS_ENDPOINT_URL") as caught:
            reach()
        assert "drop" not in str(caught.value)


def test_a_directory_told_as_a_url_is_a_directory(store, name) -> None:
    assert open_store(f"file://{store.path}").names() == [name]


@pytest.mark.parametrize("open_store", [EpisodeStore, EpisodeStore.create])
def test_nothing_is_recorded_to_a_url(open_store, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(StoreError, match="is a URL, wanted a directory; record into one"):
        open_store(Path("s3://bucket/demos"))
    assert list(tmp_path.iterdir()) == []
