"""`sheath data` with a store at a URL."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.dataset.store import EpisodeStore
from tests.s3 import BUCKET, s3_server


def names(store: Path) -> list[str]:
    return EpisodeStore(store).names()


@pytest.fixture(scope="module")
def bucket() -> Iterator[str]:
    """The URL of one that is empty."""
    with s3_server():
        yield f"s3://{BUCKET}"


class TestRemote:
    def test_push_look_pull_drop(self, sheath, made, tmp_path, bucket):
        url, store = f"{bucket}/few", tmp_path / "few"
        few = EpisodeStore.create(store)
        for name in names(made / "store")[:2]:
            few.copy_from(EpisodeStore(made / "store"), name)
        code, out, _ = sheath("data", "merge", store, "--into", url)
        assert (code, out) == (0, f"2 episodes copied into {url}, 0 were there before\n")
        for verb in ("list", "check", "show"):
            code, out, err = sheath("data", verb, url)
            assert (code, err) == (0, ""), verb
        assert (
            sheath("data", "list", url, "--card")[:2] == sheath("data", "list", store, "--card")[:2]
        )
        export = ("data", "export", url, tmp_path / "x.hdf5", "--format", "robomimic")
        assert sheath(*export)[0] == 0
        assert sheath("data", "merge", url, "--into", tmp_path / "back")[0] == 0
        assert names(tmp_path / "back") == names(store)
        first = names(store)[0]
        assert sheath("data", "drop", url, first)[:2] == (0, f"dropped {first}\n")
        assert first not in sheath("data", "list", url)[1]

    @pytest.mark.soak
    def test_a_checkpoint_is_that_of_the_directory(self, sheath, made, tmp_path, bucket):
        url, trained = f"{bucket}/corridor", tmp_path / "remote.npz"
        assert sheath("data", "merge", made / "store", "--into", url)[0] == 0
        assert sheath("train", "corridor", "--store", url, "--checkpoint", trained)[0] == 0
        assert _fitted(trained) == _fitted(made / "first.npz")

    def test_what_wants_a_directory_says_so(self, complaint, tmp_path, monkeypatch, bucket):
        monkeypatch.chdir(tmp_path)
        url = f"{bucket}/other"
        collect = ("collect", "corridor", "--episodes", 1, "--store", url)
        assert "is a URL, wanted a directory" in complaint(*collect)
        assert "is a URL, wanted a directory" in complaint("data", "repair", url)
        assert "found no sheath-store.json" in complaint("data", "list", url)
        assert list(tmp_path.iterdir()) == []


def _fitted(checkpoint: Path) -> dict[str, object]:
    with np.load(checkpoint) as content:
        header = json.loads(str(content["header"]))
        arrays = {name: content[name].tobytes() for name in content if name != "header"}
    return {"header": header, **arrays}
