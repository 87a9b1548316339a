"""The replay page: the episodes of a store, in the same scene, score and timeline as live."""

import threading
from collections.abc import Callable, Sequence

import viser

from sheath_manip.burden import StepCounts
from sheath_manip.cockpit import Cockpit
from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dashboard.drawer import Drawer
from sheath_manip.dashboard.explainer import Explainer
from sheath_manip.dashboard.layout import recorded
from sheath_manip.dashboard.page import Page
from sheath_manip.dashboard.player import Player
from sheath_manip.dashboard.scored import MOST_SCORED
from sheath_manip.dashboard.seek_socket import SeekSocket
from sheath_manip.dashboard.seeking import ReplaySeeking
from sheath_manip.dashboard.server import GuardedServer
from sheath_manip.dashboard.snapshot import snapshot_of
from sheath_manip.dashboard.wall.clips import Clipping
from sheath_manip.dashboard.wall.pages import WallPages
from sheath_manip.dashboard.widget import WidgetContext
from sheath_manip.dashboard.widgets.export import Exporting
from sheath_manip.gates.fitted import FittedGate
from sheath_manip.gates.what_if import ScoredEpisode
from sheath_manip.playback.film import Film
from sheath_manip.protocols.closing import Closes
from sheath_manip.types import TaskSpec

DRAW_RATE_HZ = 20.0


class Replay(Closes):
    """Serves the page; `run` plays on the thread that it is called on."""

    def __init__(
        self,
        spec: TaskSpec,
        catalog: EpisodeCatalog,
        film_at: Callable[[int], Film],
        exporting: Exporting,
        clipping: Clipping,
        host: str = "127.0.0.1",
        port: int = 8080,
        token: str | None = None,
        speed: float = 1.0,
        again: bool = True,
        explainer: Explainer | None = None,
        fitted: FittedGate | None = None,
    ) -> None:
        """Open the page.

        Args:
            spec: of the episodes' task.
            catalog: the episodes.
            film_at: reads one; called by `run` alone, as `exporting` and `clipping` are.
            exporting: makes a file of one.
            clipping: makes a file of some steps of one.
            host: address to listen on.
            port: 0 takes any free one.
            token: that lets a browser in; a random one by default.
            speed: to begin with.
            again: begin an episode anew at its end, else `run` returns there.
            explainer: says why a gate asked; by default from what a step records alone.
            fitted: the gate that judged, where it is known: previews look at its settings.

        Raises:
            SetupError: the port is taken.
        """
        self._catalog = catalog
        cockpit = Cockpit()
        # No run is to be paused: what plays is the player's.
        cockpit.close()
        seeking = SeekSocket(has_keys=True)
        label = f"sheath · {spec.name}"
        self.player = Player(film_at, self._wake, speed, again)
        self._wall = WallPages(catalog, self.player, clipping)
        try:
            self._server = GuardedServer.open(
                host, port, token, label, cockpit, seeking=seeking, wall=self._wall
            )
        except BaseException:
            self._wall.close()
            raise
        self._drawer = Drawer(self._draw, self._show_trouble, DRAW_RATE_HZ)
        seeking.target = ReplaySeeking(self.player, catalog)
        context = WidgetContext(self._server.viser, spec, self._drawer.wake)
        self._explainer = explainer or Explainer(spec)
        layout = recorded(spec, catalog, self.player, exporting, self._explainer, fitted)
        self._page = Page(context, layout)
        self._training = catalog.training()
        self._scored: Sequence[ScoredEpisode] = ()
        # Not waited for: of many episodes it takes a second.
        threading.Thread(target=self._read_scores, name="scores", daemon=True).start()
        self._server.viser.on_client_connect(self._greet)

    @property
    def address(self) -> str:
        """The address for the browser; contains the token, so print it for the person only."""
        return self._server.access.address

    def run(self, place: int) -> None:
        """Put on the episode at `place` and play what is asked for until `close`."""
        self.player.load(place)
        self.player.run()

    def close(self) -> None:
        """Stop playing and take the page down."""
        self.player.close()
        self._drawer.close()
        self._wall.close()
        self._explainer.close()
        self._server.close()

    def _wake(self) -> None:
        # Nothing plays before there is somebody to draw it.
        self._drawer.wake()

    def _read_scores(self) -> None:
        self._scored = self._catalog.scored(MOST_SCORED)
        self._drawer.wake()

    async def _greet(self, _: viser.ClientHandle) -> None:
        self._drawer.wake()

    def _draw(self) -> None:
        now = self.player.now
        if now.film is None or not self._page.watched:
            return
        snapshot = snapshot_of(
            now.film,
            now.at,
            series=StepCounts(),
            outcomes=self._catalog.outcomes,
            training=self._training,
            scored=self._scored,
            paused=not now.playing,
            present=False,
        )
        self._page.draw(snapshot)

    def _show_trouble(self, failure: str) -> None:
        self._page.show_trouble(failure)
