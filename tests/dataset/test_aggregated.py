"""States that grow from round to round are what joining them in memory gives."""

from pathlib import Path

import numpy as np
import pytest

from sheath_manip.dataset.aggregated import AggregatedSamples
from sheath_manip.exceptions import StoreError
from sheath_manip.types.samples import Samples, joined, samples_from
from tools.synthetic import synthetic_episode, synthetic_info

PARTS = [
    samples_from([synthetic_episode(synthetic_info(run, index), 30, 4) for index in range(2)])
    for run in range(3)
]


def columns(samples: Samples) -> dict[str, bytes]:
    images = {name: array.tobytes() for name, array in samples.images.items()}
    rest = ("features", "labels", "episodes", "steps", "actors")
    return {**images, **{name: getattr(samples, name).tobytes() for name in rest}}


def test_they_are_what_joining_gives(tmp_path: Path) -> None:
    growing, seen = AggregatedSamples(tmp_path / "runs"), []
    for number, part in enumerate(PARTS):
        growing.add(part)
        seen.append(growing.samples())
        assert columns(seen[-1]) == columns(joined(PARTS[: number + 1]))
    # What was given before stays as it was.
    assert columns(seen[0]) == columns(PARTS[0])
    assert list((tmp_path / "runs").iterdir()) == []


def test_what_is_changed_in_memory_stays_there(tmp_path: Path) -> None:
    growing = AggregatedSamples(tmp_path).add(PARTS[0])
    growing.samples().images["front"][:] = 0
    assert columns(growing.samples()) == columns(PARTS[0])


def test_images_are_not_in_memory(tmp_path: Path) -> None:
    images = np.zeros((64, 256, 256, 3), np.uint8)
    few = np.zeros((64, 1), np.float32)
    part = Samples({"front": images}, few, few, np.zeros(64, np.int64))
    growing, before = AggregatedSamples(tmp_path), anonymous_bytes()
    for _ in range(6):
        growing.add(part)
    samples = growing.samples()
    assert samples.images["front"].nbytes == 6 * images.nbytes
    assert int(samples.images["front"].max()) == 0
    assert anonymous_bytes() - before < 2 * images.nbytes


def anonymous_bytes() -> int:
    return 1024 * int(Path("/proc/self/status").read_text().split("RssAnon:")[1].split()[0])


def test_images_of_another_size_are_refused(tmp_path: Path) -> None:
    other = samples_from([synthetic_episode(synthetic_info(9, 0), 30, 5)])
    growing = AggregatedSamples(tmp_path).add(PARTS[0])
    with pytest.raises(StoreError, match=r"\(5, 5, 3\) come after some of uint8 \(4, 4, 3\)"):
        growing.add(other)


def test_a_disk_that_takes_nothing_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(StoreError, match="cannot keep"):
        AggregatedSamples(tmp_path / "file").add(PARTS[0])
    assert [entry.name for entry in tmp_path.iterdir()] == ["file"]
