"""Which widgets each page has: a widget of one's own is one file, and one line here."""

from functools import partial

from sheath_manip.cockpit import Cockpit
from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dashboard.explainer import Explainer
from sheath_manip.dashboard.following import Following
from sheath_manip.dashboard.player import Player
from sheath_manip.dashboard.playhead import Playhead
from sheath_manip.dashboard.scene import SceneView
from sheath_manip.dashboard.widget import Layout, WidgetFactory
from sheath_manip.dashboard.widgets.banner import Banner
from sheath_manip.dashboard.widgets.cameras import Cameras
from sheath_manip.dashboard.widgets.controls import Controls
from sheath_manip.dashboard.widgets.counts import Counts
from sheath_manip.dashboard.widgets.episode_list import EpisodeList
from sheath_manip.dashboard.widgets.export import Export, Exporting
from sheath_manip.dashboard.widgets.floor import Floor
from sheath_manip.dashboard.widgets.follow import FollowBox
from sheath_manip.dashboard.widgets.ghosts import Ghosts
from sheath_manip.dashboard.widgets.interventions import Interventions
from sheath_manip.dashboard.widgets.learning import LearningCurves
from sheath_manip.dashboard.widgets.lines import Lines
from sheath_manip.dashboard.widgets.look_through import LookThrough
from sheath_manip.dashboard.widgets.marking import Marking
from sheath_manip.dashboard.widgets.now_running import NowRunning
from sheath_manip.dashboard.widgets.score_plot import ScorePlot
from sheath_manip.dashboard.widgets.support_map import SupportMap
from sheath_manip.dashboard.widgets.surfaces import Surfaces
from sheath_manip.dashboard.widgets.timeline import Timeline
from sheath_manip.dashboard.widgets.tool_gizmo import ToolGizmo
from sheath_manip.dashboard.widgets.trail import Trail
from sheath_manip.dashboard.widgets.transport import Transport
from sheath_manip.dashboard.widgets.trouble import Trouble
from sheath_manip.dashboard.widgets.what_if import WhatIf
from sheath_manip.dashboard.widgets.why import Why, WhyDetails
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.types import TaskSpec


def live(
    spec: TaskSpec,
    cockpit: Cockpit,
    playhead: Playhead,
    explainer: Explainer,
    gate: tuple[WidgetFactory, ...] = (),
) -> Layout:
    """The page of a run that a person controls from `cockpit`.

    `explainer` says why the gate asks; `gate` are the sliders of one that a person may adjust.
    """
    following = _following(spec)
    return Layout(
        world=(
            partial(SceneView, following=following),
            Floor,
            Surfaces,
            Lines,
            Trail,
            Cameras,
            partial(Ghosts, explainer=explainer),
            partial(ToolGizmo, cockpit=cockpit),
        ),
        head=(
            Trouble,
            partial(Banner, cockpit=cockpit),
            partial(Controls, cockpit=cockpit),
            partial(Why, explainer=explainer),
        ),
        tabs={
            "Run": (
                ScorePlot,
                Timeline,
                partial(Interventions, look_at=playhead.look_at, release=playhead.release),
                Counts,
                partial(FollowBox, following=following),
                partial(LookThrough, following=following),
            ),
            "Why": (partial(WhyDetails, explainer=explainer),),
            "What if": gate or (WhatIf,),
            **_support(explainer),
            "Learning": (NowRunning, LearningCurves),
        },
    )


def recorded(
    spec: TaskSpec,
    catalog: EpisodeCatalog,
    player: Player,
    exporting: Exporting,
    explainer: Explainer,
    fitted: FittedGate | None = None,
) -> Layout:
    """The page of recorded episodes."""
    following = _following(spec)
    return Layout(
        world=(
            partial(SceneView, following=following),
            Floor,
            Surfaces,
            Lines,
            Trail,
            Cameras,
            partial(Ghosts, explainer=explainer),
        ),
        head=(
            Trouble,
            Banner,
            partial(Transport, player=player),
            partial(Why, explainer=explainer),
        ),
        tabs={
            "Episode": (
                partial(ScorePlot, ahead=0.5),
                Timeline,
                partial(Interventions, look_at=player.look_at),
                partial(Counts, with_series=False),
                partial(FollowBox, following=following),
                partial(LookThrough, following=following),
            ),
            "Episodes": (partial(EpisodeList, catalog=catalog, player=player),),
            "Why": (partial(WhyDetails, explainer=explainer),),
            "What if": (partial(WhatIf, fitted=fitted),),
            **_support(explainer),
            "Marks": (
                partial(Marking, catalog=catalog, player=player),
                partial(Export, player=player, exporting=exporting),
            ),
        },
    )


def _support(explainer: Explainer) -> dict[str, tuple[WidgetFactory, ...]]:
    """A picture of training states on two axes, where the gate's own neighbours are not known."""
    return {} if explainer.compares else {"Support": (SupportMap,)}


def _following(spec: TaskSpec) -> Following:
    return Following(spec.first_view is not None and spec.first_view.follows)
