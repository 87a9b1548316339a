"""A fit is not lost where its file cannot be written."""

import re
import shlex
import tempfile
from pathlib import Path

import pytest

from sheath_manip.exceptions import CheckpointError
from sheath_manip.learning.checkpoint import load_checkpoint
from sheath_manip.learning.keeping import keep
from tests.faults.checkpoint_section import SPEC, checkpoint


@pytest.fixture
def refusing(tmp_path: Path) -> Path:
    """A path that nothing can be written to."""
    (tmp_path / "file").write_text("no folder")
    return tmp_path / "file" / "first.npz"


def test_it_is_kept_in_another_folder_that_the_line_names(refusing, tmp_path, monkeypatch) -> None:
    (tmp_path / "with space").mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path / "with space"))
    with pytest.raises(CheckpointError, match=r"cannot write .*first\.npz .* the fit is") as caught:
        keep(checkpoint(0), refusing)
    command = re.findall(r"`(mv .*)`", str(caught.value))[0]
    _, kept, wanted = shlex.split(command)
    assert wanted == str(refusing)
    assert Path(kept).is_relative_to(tmp_path / "with space")
    loaded = load_checkpoint(kept, SPEC)
    assert loaded.threshold == checkpoint(0).threshold


def test_where_nothing_can_be_written_the_line_says_so(refusing, tmp_path, monkeypatch) -> None:
    for name in ("tempfile.tempdir", "HOME"):
        target = str(tmp_path / "file")
        monkeypatch.setattr(name, target) if "." in name else monkeypatch.setenv(name, target)
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    (tmp_path / "here").rmdir()
    with pytest.raises(CheckpointError, match="nor could the fit be kept in"):
        keep(checkpoint(0), refusing)
