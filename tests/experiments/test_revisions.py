"""A run that is resumed after a change says by which commits it was made."""

from sheath_manip.experiments import revisions
from sheath_manip.experiments.revisions import note_revision


def test_each_commit_is_noted_once_in_a_row(tmp_path, monkeypatch):
    told = []
    for commit in (None, "1a2b3c4", "1a2b3c4", "5d6e7f8-dirty", None, "1a2b3c4"):
        monkeypatch.setattr(revisions, "git_revision", lambda commit=commit: commit)
        told.append(note_revision(tmp_path))
    assert told[:3] == [None, "1a2b3c4", "1a2b3c4"]
    assert told[3:5] == ["1a2b3c4, then 5d6e7f8-dirty"] * 2
    assert told[5] == "1a2b3c4, then 5d6e7f8-dirty, then 1a2b3c4"
