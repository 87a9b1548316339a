import json
import tempfile
from pathlib import Path

import numpy as np
import pytest
import zarr
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from numpy.typing import NDArray
from zarr.codecs import ZstdCodec

from sheath_manip.dataset.zarr_files import array_files, files_of, group_file
from tests.cases import cases

anything = st.sampled_from(["uint8", "bool", "float32", "float64", "int64"]).flatmap(
    lambda dtype: arrays(dtype, array_shapes(min_dims=0, max_dims=4, min_side=0, max_side=5))
)


def files(folder: Path) -> dict[str, bytes]:
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file()
    }


@cases(40)
@given(anything, st.integers(1, 3))
def test_an_array_is_what_zarr_itself_writes(values: NDArray, chunk: int) -> None:
    chunks = tuple(min(chunk, max(size, 1)) for size in values.shape)
    with tempfile.TemporaryDirectory() as folder, zarr.config.set({"json_indent": None}):
        ours, theirs = Path(folder, "ours"), Path(folder, "theirs")
        made = [
            ("zarr.json", group_file({"a": [1, "ä"]})),
            *files_of("x", array_files(values, chunks)),
        ]
        for name, content in made:
            (ours / name).parent.mkdir(parents=True, exist_ok=True)
            (ours / name).write_bytes(content)
        group = zarr.create_group(theirs, zarr_format=3, attributes={"a": [1, "ä"]})
        group.create_array(
            "x",
            data=values,
            chunks=chunks,
            compressors=ZstdCodec(level=1, checksum=True),
            chunk_key_encoding={"name": "default", "separator": "."},
            config={"write_empty_chunks": True},
        )
        assert files(ours) == files(theirs)
        read = zarr.open_array(ours / "x", mode="r")
        assert np.asarray(read[...]).tobytes() == values.tobytes()


def test_attributes_are_strict_json() -> None:
    with pytest.raises(ValueError, match="not JSON compliant"):
        group_file({"a": float("nan")})
    assert json.loads(group_file({"a": 1}))["attributes"] == {"a": 1}
