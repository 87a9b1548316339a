"""Which parts the live page has: a part of one's own is one file, and one line here."""

from functools import partial

from sheath_manip.dashboard.hold import Hold
from sheath_manip.dashboard.part import Layout
from sheath_manip.dashboard.parts.banner import Banner
from sheath_manip.dashboard.parts.cameras import Cameras
from sheath_manip.dashboard.parts.counts import Counts
from sheath_manip.dashboard.parts.pause import PauseButton
from sheath_manip.dashboard.parts.plane import PlaneSupport
from sheath_manip.dashboard.parts.score_plot import ScorePlot
from sheath_manip.dashboard.parts.trouble import Trouble
from sheath_manip.dashboard.scene import SceneView


def live(hold: Hold) -> Layout:
    """The page of a run that `hold` holds."""
    return Layout(
        world=(SceneView, Cameras),
        head=(Trouble, Banner),
        tabs={
            "Run": (Counts, partial(PauseButton, hold=hold), ScorePlot),
            "Support": (PlaneSupport,),
        },
    )
