"""Spoiled and harmful files of other tools: taken in as they are, or refused in one line, whole."""

import atexit
import io
import shutil
import tempfile
import time
import zipfile
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from zlib import crc32

import h5py
import numpy as np
import zarr
from numcodecs import BZ2, LZMA, Blosc, GZip, Zlib, Zstd
from PIL import Image

from sheath_manip.dataset.exchange.exporting import export
from sheath_manip.dataset.exchange.formats import open_file
from sheath_manip.dataset.exchange.importing import Imported, Origin, import_episodes
from sheath_manip.dataset.exchange.key_map import KeyMap
from sheath_manip.dataset.exchange.selection import Selection
from sheath_manip.dataset.marker import MARKER
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import SheathError
from sheath_manip.types import EpisodeInfo, Outcome, Purpose
from tests.faults.counting import Count, Verdict, counted
from tests.faults.exchange_ways import ANY, FOLDER, SECRET, Spoil, zip_members
from tests.faults.hdf5_ways import HDF5
from tests.faults.lerobot_ways import LEROBOT
from tests.faults.minari_ways import MINARI, ZARR_3
from tools.identical import identical
from tools.synthetic import synthetic_episode, synthetic_info

MOST_S = 20.0
"""for one file, on a busy machine; an import says for itself when it takes too long"""
OF_EACH = 16
"""files of each kind spoiled in each way; a few where it must be quick"""
QUICK = 1
LENGTHS = (4, 6)
HIDDEN = np.float32(777.25)
"""what lies beside the file, and must never come in"""
KEYS = {
    "replay-buffer": ("images/top=img", "features=pos,vel", "reward=reward"),
    "robomimic": ("images/top=obs/img", "features=obs/pos"),
    "lerobot": (),
    "minari": (),
}
SETS = Path(__file__).parents[1] / "dataset" / "exchange" / "sets"
OWN = {"replay-buffer": FOLDER, "robomimic": HDF5, "lerobot": LEROBOT, "minari": MINARI}
INFO = EpisodeInfo("push", 0, Purpose.DEMONSTRATION, 10.0, method="other", variant="")
FILES = {
    "ours.zarr": "replay-buffer",
    "ours.zarr.zip": "replay-buffer",
    "ours.hdf5": "robomimic",
    "theirs.zarr": "replay-buffer",
    "theirs.zarr.zip": "replay-buffer",
    "theirs.hdf5": "robomimic",
    "theirs-3.zarr": "replay-buffer",
    "theirs-lerobot-v2.1": "lerobot",
    "theirs-lerobot-v3.0": "lerobot",
    "theirs-minari": "minari",
    "ours-minari": "minari",
}


def arrays() -> dict[str, np.ndarray]:
    rng, steps = np.random.default_rng(0), sum(LENGTHS)
    return {
        "img": rng.integers(0, 256, (steps, 5, 5, 3), np.uint8),
        "pos": rng.normal(size=(steps, 3)),
        "vel": rng.normal(size=(steps, 2)).astype(np.float32),
        "reward": rng.normal(size=steps).astype(np.float32),
        "action": rng.normal(size=(steps, 2)).astype(np.float32),
        "more": rng.integers(0, 9, steps).astype(np.int16),
    }


@cache
def sound() -> Path:
    """A folder with a sound file of each kind, and what each gives when it is taken in."""
    folder = Path(tempfile.mkdtemp(prefix="sheath-exchange-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    store = EpisodeStore.create(folder / "store")
    for index in range(2):
        store.append(synthetic_episode(synthetic_info(3, index), length=5, pixels=4))
    for name in (name for name in FILES if name.startswith("ours")):
        export(store, folder / name, FILES[name], Selection())
    root = zarr.create_group(folder / "theirs.zarr", zarr_format=2)
    codecs = (Blosc(), GZip(), BZ2(), LZMA(), Zlib(), Zstd())
    for codec, (name, values) in zip(codecs, arrays().items(), strict=True):
        root.create_array(
            f"data/{name}", data=values, chunks=(3, *values.shape[1:]), compressors=codec
        )
    root.create_array("meta/episode_ends", data=np.cumsum(LENGTHS), compressors=None)
    with zipfile.ZipFile(folder / "theirs.zarr.zip", "w") as archive:
        for file in sorted((folder / "theirs.zarr").rglob("*")):
            archive.write(file, file.relative_to(folder / "theirs.zarr"))
    with h5py.File(folder / "theirs.hdf5", "w") as file:
        for number, part in enumerate((slice(0, 4), slice(4, 10))):
            values = {name: array[part] for name, array in arrays().items()}
            demo = file.create_group(f"data/demo_{number}")
            demo.attrs["num_samples"] = len(values["action"])
            demo["actions"], demo["rewards"] = values["action"], values["reward"]
            options = {"compression": "gzip", "shuffle": True, "fletcher32": True}
            demo.create_dataset("obs/img", data=values["img"], **options)
            demo.create_dataset("obs/pos", data=values["pos"], compression="lzf")
            demo["next_obs/pos"] = values["pos"] + 1
    newer = zarr.create_group(folder / "theirs-3.zarr", zarr_format=3)
    for name, values in arrays().items():
        newer.create_array(f"data/{name}", data=values, chunks=(3, *values.shape[1:]))
    newer.create_array("meta/episode_ends", data=np.cumsum(LENGTHS))
    for version in ("v2.1", "v3.0"):
        shutil.copytree(SETS / f"lerobot-{version}", folder / f"theirs-lerobot-{version}")
    write_minari(folder / "theirs-minari" / "data")
    np.full(10_000, HIDDEN).tofile(folder / SECRET)
    with h5py.File(folder / "other.hdf5", "w") as file:
        file["x"] = np.full((6, 3), HIDDEN)
    for name in FILES:
        taken_in(folder / name, folder / f"from-{name}")
    return folder


def write_minari(data: Path) -> None:
    """Two episodes as Minari keeps them, a camera's images as JPEGs."""
    data.mkdir(parents=True)
    (data / "metadata.json").write_text('{"dataset_id": "x-v0", "data_format": "hdf5"}')
    with h5py.File(data / "main_data.hdf5", "w") as file:
        for number, (start, stop) in enumerate(((0, 4), (4, 10))):
            values = {name: array[start:stop] for name, array in arrays().items()}
            group, length = file.create_group(f"episode_{number}"), stop - start
            group["actions"], group["rewards"] = values["action"], values["reward"]
            group["terminations"] = group["truncations"] = np.arange(length) == length - 1
            group["infos/success"] = np.ones(length, bool)
            group["observations/pos"] = np.zeros((length + 1, 3), np.float32)
            kind = h5py.vlen_dtype(np.uint8)
            images = group.create_dataset("observations/camera", (length + 1,), kind)
            for t in range(length + 1):
                out = io.BytesIO()
                Image.fromarray(values["img"][min(t, length - 1)]).save(out, "JPEG")
                images[t] = np.frombuffer(out.getvalue(), np.uint8)


def taken_in(path: Path, store: Path) -> Imported:
    form = FILES[path.name]
    origin = None
    if path.name.startswith("theirs"):
        origin = Origin(INFO, Outcome.SUCCESS, KeyMap.parse(KEYS[form]))
    return import_episodes(open_file(form, path), EpisodeStore.create(store), origin)


def hidden(store: EpisodeStore) -> bool:
    """Whether something of what lies beside the file came in."""
    held = (store.recorded(name).arrays.values() for name in store.names())
    secret = HIDDEN.tobytes()
    return any(secret in np.asarray(array).tobytes() for each in held for array in each)


def verdict(name: str, way: str, spoil: Spoil, number: int) -> Verdict:
    """Spoil a file, take it in, and see what came of it."""
    rng = np.random.default_rng([number, crc32(f"{name} {way}".encode())])
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        path, back = folder / name, folder / "back"
        (shutil.copytree if (sound() / name).is_dir() else shutil.copy)(sound() / name, path)
        for beside in (SECRET, "other.hdf5"):
            shutil.copy(sound() / beside, folder / beside)
        spoil(path, rng)
        began_s = time.monotonic()
        try:
            done = taken_in(path, back)
            store, held = EpisodeStore(back), EpisodeStore(sound() / f"from-{name}")
            same = store.names() == held.names() and all(
                identical(store.read(each), held.read(each)) for each in held.names()
            )
            survived, told = not hidden(store), same or not done.sealed
            came = "the same" if same else "another" if told else "silently another"
        except SheathError as error:
            came = str(error)
            left = sorted(entry.name for entry in back.iterdir()) if back.exists() else []
            survived = "\n" not in came and len(came) < 1500 and left in ([], [MARKER])
            told = survived
        except Exception as error:
            survived, told, came = False, False, f"{type(error).__name__}: {error}"
        took_s = time.monotonic() - began_s
    survived &= took_s < MOST_S
    told &= survived
    kind = f"{way} ({FILES[name]})"
    return Verdict(kind, survived, told, f"{name}, {way} {number}, {took_s:.1f} s: {came[:300]}")


def ways(name: str) -> Mapping[str, Spoil]:
    """Return the ways to spoil that file."""
    if name.endswith(".zip"):
        return {**ANY, "members of the archive": zip_members}
    return {**ANY, **OWN[FILES[name]], **(ZARR_3 if name.endswith("3.zarr") else {})}


def verdicts(of_each: int) -> Iterator[Verdict]:
    """Spoil so many files of each kind in each way."""
    for name in FILES:
        for way, spoil in ways(name).items():
            # A single file that is missing is no case, and zarr's format 3 has no .zarray.
            single = way == "files missing" and name.endswith((".zip", ".hdf5"))
            if single or (name.endswith("3.zarr") and way in FOLDER):
                continue
            for number in range(of_each):
                yield verdict(name, way, spoil, number)


def counts(quick: bool) -> Mapping[str, Count]:
    """Return what became of all files, by the way in which they were spoiled."""
    return counted(verdicts(QUICK if quick else OF_EACH))
