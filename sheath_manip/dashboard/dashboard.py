"""The live page of a run: a listener that copies what happens, and a thread that draws it."""

import contextlib
import threading
from collections import deque
from collections.abc import Mapping
from types import TracebackType
from typing import Self

import numpy as np
import viser
from numpy.typing import NDArray

from sheath_manip.cockpit import Cockpit
from sheath_manip.dashboard.drawer import Drawer
from sheath_manip.dashboard.layout import live
from sheath_manip.dashboard.moment import Moment
from sheath_manip.dashboard.page import Page
from sheath_manip.dashboard.part import Desk
from sheath_manip.dashboard.server import GuardedServer
from sheath_manip.dashboard.tally import HISTORY_STEPS, Tally
from sheath_manip.dataset.samples import Samples
from sheath_manip.exceptions import ParameterError
from sheath_manip.protocols import Environment
from sheath_manip.types import Actor, Episode, EpisodeInfo, SceneGeom, Step, TaskSpec

DRAW_RATE_HZ = 12.0


class Dashboard:
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
    ) -> None:
        """Open the page; `cockpit` is where a person's orders go, by default one to hold the run.

        Raises SetupError (the port is taken) and ParameterError (a short token).
        """
        self._plane = [spec.feature_names.index(name) for name in spec.plane or ()]
        self.cockpit = cockpit or Cockpit()
        label = f"sheath · {spec.name}"
        self._server = GuardedServer.open(host, port, token, label, self.cockpit)
        self._drawer = Drawer(self._draw_latest, self._show_trouble, DRAW_RATE_HZ)
        self._page = Page(Desk(self._server.viser, spec, self._drawer.wake), live(self.cockpit))

        self._lock = threading.Lock()
        self._tally = Tally()
        self._trail: deque[tuple[float, float, Actor]] = deque(maxlen=HISTORY_STEPS)
        self._geoms: tuple[SceneGeom, ...] = ()
        self._poses = np.zeros((0, 7))
        self._images: Mapping[str, NDArray[np.uint8]] = {}
        self._training: NDArray[np.float64] | None = None

        self._closed = threading.Event()
        self._server.viser.on_client_connect(self._greet)
        self.cockpit.on_change = self._drawer.wake

    @property
    def address(self) -> str:
        """Where to point the browser; contains the token, so print it for the person only."""
        return self._server.access.address

    @property
    def paused(self) -> bool:
        """Whether the person holds the run."""
        return self.cockpit.paused

    def show_training(self, positions: NDArray) -> None:
        """Show where the policy was fitted: (n, 2) metres in `TaskSpec.plane`."""
        points = np.array(positions, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != 2:
            raise ParameterError(f"positions have shape {points.shape}; wanted (n, 2) metres")
        with self._lock:
            self._training = points
        self._drawer.wake()

    def on_fit(self, states: Samples) -> None:
        """Show where policy and support were fitted, on tasks with a plane."""
        if self._plane:
            self.show_training(states.features[:, self._plane])

    def on_start(self, environment: Environment, info: EpisodeInfo) -> None:
        """Show the new episode's scene."""
        geoms = tuple(environment.scene())
        poses = np.array(environment.body_poses())
        with self._lock:
            self._tally.start(info)
            self._trail.clear()
            self._geoms, self._poses, self._images = geoms, poses, {}
        self._drawer.wake()

    def on_step(self, environment: Environment, step: Step) -> None:
        """Take note of the step; blocks while the person holds the run paused."""
        poses = np.array(environment.body_poses())
        with self._lock:
            self._tally.step(step)
            self._poses, self._images = poses, step.observation.images
            if self._plane:
                x, y = step.observation.features[self._plane]
                self._trail.append((float(x), float(y), step.decision.actor))
        self._drawer.wake()
        self.cockpit.wait()

    def on_end(self, episode: Episode) -> None:
        """Show how the episode ended."""
        with self._lock:
            self._tally.end(episode.outcome)
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
        """Keep the page alive until Ctrl-C or `close`."""
        with contextlib.suppress(KeyboardInterrupt):
            self._closed.wait()

    def close(self) -> None:
        """Let a paused run go on, stop drawing and take the page down."""
        if self._closed.is_set():
            return
        self._closed.set()
        self.cockpit.close()
        self._drawer.close()
        self._server.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    async def _greet(self, _: viser.ClientHandle) -> None:
        self._drawer.wake()

    def _latest(self) -> Moment | None:
        with self._lock:
            figures = self._tally.figures
            if figures is None:
                return None
            return Moment(
                self._geoms,
                self._poses,
                figures,
                tuple(self._tally.scores),
                tuple(self._trail),
                self._images,
                self._training,
                self.cockpit.paused,
            )

    def _draw_latest(self) -> None:
        if not self._page.watched:
            return
        moment = self._latest()
        if moment is not None:
            self._page.draw(moment)

    def _show_trouble(self, failure: str) -> None:
        self._page.show_trouble(failure)
