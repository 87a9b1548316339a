"""ReplayBuffers of zarr's format 3, and those whose images are encoded one by one."""

import json
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import zarr
from zarr.codecs import BloscCodec, Crc32cCodec, GzipCodec, ZstdCodec

from sheath_manip.dataset.exchange.formats import open_file
from sheath_manip.dataset.exchange.importing import NOTHING_TOLD, import_episodes
from sheath_manip.dataset.exchange.key_map import KeyMap
from sheath_manip.exceptions import SetupError, StoreError

LENGTHS = (4, 6)
STEPS = sum(LENGTHS)
INFO = replace(NOTHING_TOLD.info, task="push", control_rate_hz=10.0)


def arrays() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(0)
    return {
        "img": rng.integers(0, 256, (STEPS, 5, 4, 3), np.uint8),
        "pos": rng.normal(size=(STEPS, 3)).astype(np.float32),
        "big": rng.normal(size=(STEPS, 2)).astype(">f8"),
        "action": rng.normal(size=(STEPS, 2)).astype(np.float32),
    }


CODECS = (ZstdCodec(), (BloscCodec(), Crc32cCodec()), GzipCodec(), None)


@pytest.fixture
def buffer(tmp_path: Path) -> Path:
    root = zarr.create_group(tmp_path / "b.zarr", zarr_format=3)
    for codec, (name, values) in zip(CODECS, arrays().items(), strict=True):
        chunks = (3, *values.shape[1:])
        root.create_array(f"data/{name}", data=values, chunks=chunks, compressors=codec)
    root.create_array("meta/episode_ends", data=np.cumsum(LENGTHS), fill_value=7)
    return tmp_path / "b.zarr"


def taken_in(path: Path, store, *keys: str):
    told = replace(NOTHING_TOLD, info=INFO, keys=KeyMap.parse(keys))
    return import_episodes(open_file("replay-buffer", path), store, told)


def test_format_3_comes_in(buffer, store) -> None:
    assert taken_in(buffer, store, "images/top=img", "features=pos", "state=big").added == 2
    _, second = sorted(map(store.recorded, store.names()), key=lambda each: each.header.info.index)
    wanted = arrays()
    assert np.array_equal(second.arrays["images/top"], wanted["img"][4:])
    assert np.array_equal(second.arrays["features"], wanted["pos"][4:])
    assert np.array_equal(second.arrays["state"], wanted["big"][4:])


def test_a_chunk_with_another_checksum_leaves_nothing(buffer, store) -> None:
    chunk = buffer / "data" / "pos" / "c" / "1" / "0"
    content = bytearray(chunk.read_bytes())
    content[-1] ^= 1
    chunk.write_bytes(bytes(content))
    with pytest.raises(StoreError, match=r"nothing is imported: episode 0 .*another checksum"):
        taken_in(buffer, store, "features=pos")
    assert [entry.name for entry in store.path.iterdir()] == ["sheath-store.json"]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"codecs": [{"name": "sharding_indexed"}]}, "has the codecs 'sharding_indexed'"),
        ({"codecs": [{"name": "bytes"}, {"name": "numcodecs.pickle"}]}, "wanted bytes, then"),
        ({"data_type": "string"}, "holds 'string'"),
        ({"shape": [10**15, 10**15]}, "asks for|has shape|chunks"),
        ({"chunk_grid": {"name": "x", "configuration": {}}}, "wanted a regular one"),
        ({"zarr_format": 2}, "no array of zarr's format 3"),
    ],
)
def test_what_is_not_read_is_one_line(buffer, changes, message) -> None:
    file = buffer / "data" / "pos" / "zarr.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | changes))
    with pytest.raises(StoreError, match=message):
        open_file("replay-buffer", buffer)


@pytest.fixture
def umi(tmp_path: Path) -> Path:
    """As UMI writes them: a chunk is one image, encoded."""
    root = zarr.create_group(tmp_path / "umi.zarr", zarr_format=2)
    values = arrays()
    root.create_array("data/action", data=values["action"])
    root.create_array("meta/episode_ends", data=np.cumsum(LENGTHS))
    root.create_array("data/camera0_rgb", data=values["img"], chunks=(1, 5, 4, 3), compressors=None)
    file = tmp_path / "umi.zarr" / "data" / "camera0_rgb" / ".zarray"
    told = json.loads(file.read_text()) | {"compressor": {"id": "imagecodecs_jpegxl", "level": 99}}
    file.write_text(json.dumps(told))
    return tmp_path / "umi.zarr"


def test_images_of_umi_want_a_package_that_is_named(umi, store, monkeypatch) -> None:
    assert taken_in(umi, store, "features=action").added == 2
    monkeypatch.setitem(sys.modules, "imagecodecs", None)
    with pytest.raises(SetupError, match=r"wants the package imagecodecs.*sheath-manip\[umi\]"):
        next(iter(open_file("replay-buffer", umi).tracks())).read("camera0_rgb")

    def decode(content: bytes) -> np.ndarray:
        return np.frombuffer(content, np.uint8).reshape(5, 4, 3)

    monkeypatch.setitem(sys.modules, "imagecodecs", SimpleNamespace(jpegxl_decode=decode))
    images = next(iter(open_file("replay-buffer", umi).tracks())).read("camera0_rgb")
    assert np.array_equal(images, arrays()["img"][:4])
