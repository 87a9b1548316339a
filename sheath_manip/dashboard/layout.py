"""Which parts the live page has: a part of one's own is one file, and one line here."""

from functools import partial

from sheath_manip.cockpit import Cockpit
from sheath_manip.dashboard.part import Layout
from sheath_manip.dashboard.parts.banner import Banner
from sheath_manip.dashboard.parts.cameras import Cameras
from sheath_manip.dashboard.parts.controls import Controls
from sheath_manip.dashboard.parts.counts import Counts
from sheath_manip.dashboard.parts.plane import PlaneSupport
from sheath_manip.dashboard.parts.score_plot import ScorePlot
from sheath_manip.dashboard.parts.tool_gizmo import ToolGizmo
from sheath_manip.dashboard.parts.trouble import Trouble
from sheath_manip.dashboard.scene import SceneView


def live(cockpit: Cockpit) -> Layout:
    """The page of a run that a person controls from `cockpit`."""
    return Layout(
        world=(SceneView, Cameras, partial(ToolGizmo, cockpit=cockpit)),
        head=(Trouble, Banner, partial(Controls, cockpit=cockpit)),
        tabs={
            "Run": (Counts, ScorePlot),
            "Support": (PlaneSupport,),
        },
    )
