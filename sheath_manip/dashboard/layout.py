"""Which parts the live page has: a part of one's own is one file, and one line here."""

from functools import partial

from sheath_manip.cockpit import Cockpit
from sheath_manip.dashboard.following import Following
from sheath_manip.dashboard.part import Layout
from sheath_manip.dashboard.parts.banner import Banner
from sheath_manip.dashboard.parts.cameras import Cameras
from sheath_manip.dashboard.parts.controls import Controls
from sheath_manip.dashboard.parts.counts import Counts
from sheath_manip.dashboard.parts.follow import FollowBox
from sheath_manip.dashboard.parts.interventions import Interventions
from sheath_manip.dashboard.parts.score_plot import ScorePlot
from sheath_manip.dashboard.parts.support_map import SupportMap
from sheath_manip.dashboard.parts.surfaces import Surfaces
from sheath_manip.dashboard.parts.timeline import Timeline
from sheath_manip.dashboard.parts.tool_gizmo import ToolGizmo
from sheath_manip.dashboard.parts.trail import Trail
from sheath_manip.dashboard.parts.trouble import Trouble
from sheath_manip.dashboard.playhead import Playhead
from sheath_manip.dashboard.scene import SceneView
from sheath_manip.types import TaskSpec


def live(spec: TaskSpec, cockpit: Cockpit, playhead: Playhead) -> Layout:
    """The page of a run that a person controls from `cockpit`."""
    following = Following(spec.first_view is not None and spec.first_view.follows)
    return Layout(
        world=(
            partial(SceneView, following=following),
            Surfaces,
            Trail,
            Cameras,
            partial(ToolGizmo, cockpit=cockpit),
        ),
        head=(Trouble, Banner, partial(Controls, cockpit=cockpit)),
        tabs={
            "Run": (
                ScorePlot,
                Timeline,
                partial(Interventions, playhead=playhead),
                Counts,
                partial(FollowBox, following=following),
            ),
            "Support": (SupportMap,),
        },
    )
