"""The live page of a run: a listener that copies what happens, and a thread that draws it."""

import contextlib
import math
import sys
import threading
import time

import viser

from sheath_manip.cockpit import Cockpit
from sheath_manip.cockpit.question import Question
from sheath_manip.dashboard.drawer import Drawer
from sheath_manip.dashboard.explainer import Explainer
from sheath_manip.dashboard.layout import live
from sheath_manip.dashboard.operator_socket import station_of
from sheath_manip.dashboard.page import Page
from sheath_manip.dashboard.pictures_socket import Pictures, PicturesSocket
from sheath_manip.dashboard.playhead import Playhead
from sheath_manip.dashboard.scored import MOST_SCORED, scored
from sheath_manip.dashboard.seek_socket import SeekSocket
from sheath_manip.dashboard.seeking import RunSeeking
from sheath_manip.dashboard.server import GuardedServer
from sheath_manip.dashboard.snapshot import Snapshot, snapshot_of
from sheath_manip.dashboard.tally import Tally, counts_of_trace
from sheath_manip.dashboard.widget import WidgetContext, WidgetFactory
from sheath_manip.gates.what_if import ScoredEpisode
from sheath_manip.learning.results import RoundResult
from sheath_manip.playback.film import Film, film_begun, pose_of
from sheath_manip.protocols import Environment
from sheath_manip.protocols.closing import Closes
from sheath_manip.types import Episode, EpisodeInfo, Step, TaskSpec
from sheath_manip.types.samples import Samples
from sheath_manip.types.work import Headway, Work

DRAW_RATE_HZ = 20.0
SWITCH_INTERVAL_S = 0.0005
"""after which the control loop gets the interpreter back from a thread that draws"""


class Dashboard(Closes):
    """Shows a run in the browser and lets a person pause it; a `Listener` for `rollout`.

    The control loop is held up only while the person has paused it. Nothing is drawn while nobody
    looks.
    """

    def __init__(
        self,
        spec: TaskSpec,
        host: str = "127.0.0.1",
        port: int = 8080,
        token: str | None = None,
        cockpit: Cockpit | None = None,
        gate: tuple[WidgetFactory, ...] = (),
        explainer: Explainer | None = None,
        pictures: Pictures = dict,
    ) -> None:
        """Open the page.

        `cockpit` is where a person's orders go, by default one to hold the run; `gate` are the
        sliders of a gate that a person may adjust; `explainer` says why it asks, by default
        from what a step records alone; `pictures` are what each of several robots sees.

        Raises SetupError (the port is taken) and ParameterError (a short token).
        """
        self.cockpit = cockpit or Cockpit()
        self.saved_in = ""
        """where the run is recorded, for the page to say at its end"""
        self._blind_since_s = math.inf
        """since when nothing more is heard of the episode"""
        label = f"sheath · {spec.name}"
        seeking = SeekSocket()
        self._server = GuardedServer.open(
            *(host, port, token, label, self.cockpit, self._true_s, seeking),
            pictures=PicturesSocket(pictures),
        )
        # Else the loop waits up to 5 ms for its turn where a drawing is under way.
        sys.setswitchinterval(min(sys.getswitchinterval(), SWITCH_INTERVAL_S))
        self._closed = threading.Event()
        self._drawer = Drawer(self._draw_latest, self._show_trouble, DRAW_RATE_HZ)
        self._playhead = Playhead(self._drawer.wake)
        seeking.target = RunSeeking(self._playhead)
        context = WidgetContext(self._server.viser, spec, self._drawer.wake, self._allows)
        self._explainer = explainer or Explainer(spec)
        self._explainer.question = self._question
        layout = live(spec, self.cockpit, self._playhead, self._explainer, gate)
        self._page = Page(context, layout)
        self._lock = threading.Lock()
        self._tally = Tally()
        self._film: Film | None = None
        self._training: Samples | None = None
        self._results: tuple[RoundResult, ...] = ()
        self._headway: Headway | None = None
        self._work = ""
        self._scored: tuple[ScoredEpisode, ...] = ()
        self._server.viser.on_client_connect(self._greet)
        self.cockpit.on_change = self._drawer.wake

    @property
    def address(self) -> str:
        """The address for the browser; contains the token, so print it for the person only."""
        return self._server.access.address

    @property
    def paused(self) -> bool:
        """Whether the person holds the run."""
        return self.cockpit.paused

    def on_fit(self, states: Samples) -> None:
        """Show where policy and support were fitted."""
        self._training = states
        self._drawer.wake()

    def on_round(self, result: RoundResult) -> None:
        """Show what a round of learning came to."""
        self._results = (*self._results, result)
        self._drawer.wake()

    def on_work(self, work: Work | None) -> None:
        """Say what is done while no episode runs."""
        self.cockpit.between.note_work(work)
        what = "" if work is None else work.what
        if what != self._work:
            self._work = what
            self._drawer.wake()

    def on_headway(self, headway: Headway) -> None:
        """Show how far the whole run is."""
        self._headway = headway
        self._drawer.wake()

    def on_start(self, environment: Environment, info: EpisodeInfo) -> None:
        """Show the new episode's scene; blocks while the person holds the run paused."""
        self._blind_since_s = math.inf
        self._film = film_begun(environment, info)
        self._playhead.load(self._film)
        self.cockpit.between.note_episode(runs=True)
        # Else a run that was paused, or stopped and reset, between two episodes would begin.
        self.cockpit.wait(environment)

    def on_step(self, environment: Environment, step: Step) -> None:
        """Take note of the step; blocks while the person holds the run paused."""
        assert self._film is not None, "on_start comes before on_step"
        self._film.append(step, pose_of(environment))
        self._drawer.wake()
        self.cockpit.wait(environment)

    def on_dropped(self) -> None:
        """Know that the page stands still: nobody may drive by it."""
        self._blind_since_s = time.monotonic()

    def on_end(self, episode: Episode) -> None:
        """Show how the episode ended."""
        assert self._film is not None, "on_start comes before on_end"
        self.count(self._film, episode)
        self.cockpit.between.note_episode(runs=False)

    def show(self, film: Film) -> None:
        """Show that episode from now on, also to those who look back: of another robot, say."""
        self._playhead.release()
        self._playhead.load(film)

    def count(self, film: Film, episode: Episode) -> None:
        """Count an episode that has ended, and show how where it is the one shown."""
        with self._lock:
            film.end(episode)
            trace = film.trace.so_far()
            counts = counts_of_trace(trace, episode.info.control_rate_hz)
            self._tally.end(episode.info, counts, episode.outcome)
            self._scored = (*self._scored, scored(film))[-MOST_SCORED:]
        self._drawer.wake()

    def pause(self) -> None:
        """Hold the run at its next step, as the page's button does."""
        self.cockpit.pause()
        self._drawer.wake()

    def resume(self) -> None:
        """Let the run go on."""
        self.cockpit.resume()
        self._drawer.wake()

    def hold_open(self) -> None:
        """Say that the run has ended; keep the page alive until Ctrl-C or `close`."""
        self.cockpit.close()
        self._server.say_finished(self.saved_in)
        with contextlib.suppress(KeyboardInterrupt):
            self._closed.wait()

    def close(self) -> None:
        """Let a paused run go on, stop drawing and take the page down."""
        if self._closed.is_set():
            return
        self._closed.set()
        self.cockpit.close()
        self._drawer.close()
        self._explainer.close()
        self._server.close(self.saved_in)

    def _allows(self, client_id: int | None) -> bool:
        """Whether that browser may change what the run does: while somebody drives only that one.

        Who sets an element by program has no browser, and may.
        """
        holder = self.cockpit.lease.holder
        return client_id is None or holder in (None, station_of(client_id))

    def _true_s(self) -> float:
        """Up to when the page is true: what is drawn, what is known of the loop and heard of it."""
        return min(self._drawer.true_s, self.cockpit.true_s, self._blind_since_s)

    def _question(self) -> Question | None:
        """What the run stands still before, since the gate asks for a person."""
        asking = self.cockpit.still and self.cockpit.state.asking
        return self.cockpit.question if asking else None

    async def _greet(self, _: viser.ClientHandle) -> None:
        self._drawer.wake()

    def _latest(self) -> Snapshot | None:
        if self.cockpit.lease.holder is not None:
            # Nobody drives by the past, whether or not somebody wants to look back meanwhile.
            self._playhead.release()
        shown = self._playhead.shown
        if shown is None:
            return None
        film, at, present = shown
        with self._lock:
            return snapshot_of(
                film,
                at,
                series=self._tally.counts(film.info),
                outcomes=self._tally.outcomes(film.info),
                training=self._training,
                results=self._results,
                headway=self._headway,
                work=self._work,
                scored=self._scored,
                paused=self.cockpit.paused,
                present=present,
            )

    def _draw_latest(self) -> None:
        if not self._page.watched:
            return
        snapshot = self._latest()
        if snapshot is not None:
            self._page.draw(snapshot)

    def _show_trouble(self, failure: str) -> None:
        self._page.show_trouble(failure)
