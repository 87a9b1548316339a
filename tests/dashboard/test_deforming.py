"""What deforms and grows in the scene: surfaces and lines."""

from types import SimpleNamespace
from typing import cast

import numpy as np

from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.dashboard.widgets.lines import Lines
from sheath_manip.dashboard.widgets.surfaces import Surfaces
from sheath_manip.types import Line, ScenePose, Surface
from tests.dashboard.conftest import SPEC

SQUARE_M = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], np.float32)
FACES = np.array([(0, 1, 2), (0, 2, 3)], np.int32)


def snapshot_of(surfaces: tuple[Surface, ...] = (), lines: tuple[Line, ...] = ()) -> Snapshot:
    pose = ScenePose(np.zeros((0, 7)), surfaces=surfaces, lines=lines)
    return cast(Snapshot, SimpleNamespace(pose=pose))


def test_a_sheet_is_cut_without_a_new_node(dashboard: Dashboard) -> None:
    widget = Surfaces(WidgetContext(dashboard._server.viser, SPEC, lambda: None))
    widget.draw(snapshot_of((Surface(SQUARE_M, FACES, (1.0, 0.5, 0.0)),)))
    node = widget._meshes[0]
    # The diagonal is cut: its ends are doubled, and one half moves away.
    apart = np.concatenate([SQUARE_M, SQUARE_M[[0, 2]] + [0, 0.1, 0]]).astype(np.float32)
    cut = np.array([(0, 1, 2), (4, 5, 3)], np.int32)
    widget.draw(snapshot_of((Surface(apart, cut, (1.0, 0.5, 0.0)),)))
    assert widget._meshes == [node]
    np.testing.assert_array_equal(node.vertices, apart)
    np.testing.assert_array_equal(node.faces, cut)
    widget.draw(snapshot_of())
    assert widget._meshes == []


def test_a_line_grows_and_is_hidden_while_it_is_a_point(dashboard: Dashboard) -> None:
    widget = Lines(WidgetContext(dashboard._server.viser, SPEC, lambda: None))
    widget.draw(snapshot_of(lines=(Line(SQUARE_M[:1], (1.0, 0.0, 0.0)),)))
    node = widget._lines[0]
    assert not node.visible
    widget.draw(snapshot_of(lines=(Line(SQUARE_M, (1.0, 0.0, 0.0)),)))
    assert widget._lines == [node]
    assert node.visible
    np.testing.assert_array_equal(node.points, np.stack([SQUARE_M[:-1], SQUARE_M[1:]], axis=1))
    assert node.colors.shape == (3, 2, 3)
    assert (node.colors[..., 0] == 255).all()
    widget.draw(snapshot_of())
    assert widget._lines == []
