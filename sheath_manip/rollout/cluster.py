"""Episodes run by the workers of a Ray cluster: this machine, or as many as there are.

Nothing need be shared but the code. A driver's checkpoint travels once to each machine, through
Ray's object store, and an episode that is recorded comes back to be written here.
"""

import logging
import os
import sys
import tempfile
import threading
import uuid
from collections import OrderedDict
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Any

import numpy as np

from sheath_manip.dataset.extras import needs
from sheath_manip.dataset.naming import episode_name
from sheath_manip.dataset.recorded import Frames, Recorded
from sheath_manip.dataset.recorder import Recorder
from sheath_manip.dataset.steps import recorded_of
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import SetupError, WorkerError
from sheath_manip.rollout.crowd import Crowd, LostWorkerError
from sheath_manip.rollout.device import VARIABLE
from sheath_manip.rollout.elsewhere import CrowdExecutor
from sheath_manip.rollout.request import EpisodeRequest
from sheath_manip.rollout.threads import single_threaded
from sheath_manip.rollout.worker import Answer, Errand, answer_of, without_images
from sheath_manip.rollout.workplace import Workplace
from sheath_manip.types import Episode

logger = logging.getLogger(__name__)

MOST_CHECKPOINTS = 64
"""that stay in the object store; one of them drives a round"""
PATIENCE_S = 60.0
"""until it is told that a worker waits for a free core of the cluster"""
ENVIRONMENT = ("MUJOCO_GL", "OMP_NUM_THREADS", "MKL_NUM_THREADS", VARIABLE)
"""variables that a worker takes over where they are set"""
SAME = ("sheath-manip", "numpy", "torch", "mujoco")
"""packages whose other version gives other bytes"""


class RayExecutor(CrowdExecutor):
    """Hands requests to actors of Ray, a core each; one that is lost costs its episode only."""

    def __init__(self, workers: int | None = None, address: str | None = None) -> None:
        """Connect to the cluster at `address`, or start one of this machine for as long as it runs.

        Args:
            workers: how many; None: as many as the cluster has cores now.
            address: such as `auto` for that of this machine, or `host:6379` of its head; None: that
                of RAY_ADDRESS, or no cluster.

        Raises SetupError where Ray is not installed or no cluster answers, and ParameterError for
        fewer workers than one.
        """
        with needs("ray", "ray"):
            import ray  # pyright: ignore[reportMissingImports] - an extra

        self._ray = ray
        self._connected = not ray.is_initialized()
        if self._connected:
            _connect(ray, workers, address or os.environ.get("RAY_ADDRESS"))
        cores = int(ray.cluster_resources().get("CPU", 0))
        self._files = _Files(ray)
        super().__init__(Crowd(cores if workers is None else workers, self._hired))

    def close(self) -> None:
        """End the workers, and leave the cluster."""
        super().close()
        if self._connected:
            self._connected = False
            self._ray.shutdown()

    def _hired(self) -> "RayWorker":
        return RayWorker(self._ray, self._files)


class RayWorker:
    """One actor, as it is seen from here."""

    def __init__(self, ray: Any, files: "_Files") -> None:
        """Ask for it; it is there once the cluster has a core for it."""
        variables = {name: os.environ[name] for name in ENVIRONMENT if name in os.environ}
        # An actor that is lost is replaced from here, with the episode that it was at.
        self._actor = ray.remote(num_cpus=1, max_restarts=0)(Actor).remote(
            variables, tuple(sys.path)
        )
        self._ray, self._files = ray, files

    def begin(self) -> None:
        """Wait for it; raises LostWorkerError, and WorkerError where it has other versions."""
        late = threading.Timer(PATIENCE_S, self._complain)
        late.daemon = True
        late.start()
        try:
            theirs = self._got(self._actor.versions.remote())
        finally:
            late.cancel()
        for name, version in versions().items():
            if theirs.get(name) != version:
                raise WorkerError(
                    f"a machine of the cluster has {name} {theirs.get(name, '(none)')}; wanted "
                    f"{version}, as here"
                )

    def run(self, errand: Errand) -> Answer:
        """Run it and wait, and record the episode here; raises LostWorkerError."""
        answer = self._replied(errand)
        if isinstance(answer, Answer):
            return answer
        assert errand.store is not None
        return answer_of(partial(_keep, EpisodeStore(errand.store), answer))

    def _replied(self, errand: Errand) -> Answer | Recorded:
        request, recorded = errand.request, errand.store is not None
        try:
            digest, files = self._files.of(request)
            reply = self._actor.run.remote(request, digest, files, recorded)
        except Exception as error:
            # What cannot be pickled says so in many ways.
            return Answer(
                fault=WorkerError(
                    f"{episode_name(request.info)} cannot be sent to a worker "
                    f"({type(error).__name__}: {error}); wanted a driver and a task that can be "
                    "pickled, whose files are here"
                )
            )
        try:
            return self._got(reply)
        except WorkerError as fault:
            return Answer(fault=fault)

    def end(self) -> None:
        """End it."""
        self._ray.kill(self._actor)

    def _got(self, reference: Any) -> Any:
        try:
            return self._ray.get(reference)
        except self._ray.exceptions.RayTaskError as error:
            # Not the worker is lost: it answered that it cannot, such as for a missing module.
            raise WorkerError(f"a worker failed ({_lines(error)[-1]})") from None
        except self._ray.exceptions.RayError as error:
            raise LostWorkerError(f"with {_lines(error)[0]}") from error

    @staticmethod
    def _complain() -> None:
        logger.warning(
            "a worker waits for a free core of the cluster since %.0f s; the others go on",
            PATIENCE_S,
        )


class Actor:
    """A worker, where it is: it keeps its environment, and the checkpoint that drives it."""

    def __init__(self, variables: Mapping[str, str], path: Sequence[str]) -> None:
        """Make nothing yet: the first request says what is wanted.

        Args:
            variables: of the environment, set before a simulator is imported.
            path: further places of modules, such as the folder of a task of somebody's own.
        """
        os.environ.update(variables)
        sys.path += [place for place in path if place not in sys.path]
        self._threads = single_threaded()
        self._threads.__enter__()
        self._workplace = Workplace()
        self._name = f"sheath-{uuid.uuid4().hex}"

    def versions(self) -> Mapping[str, str]:
        """Return the versions of the packages that episodes depend on."""
        return versions()

    def run(
        self, request: EpisodeRequest, digest: str, content: Sequence[Any], recorded: bool
    ) -> Answer | Recorded:
        """Run the episode, and return it by column where it is to be recorded.

        `content` refers to the file of the driver's checkpoint, if it has one.
        """
        kept = _Kept() if recorded else None

        def run() -> Answer:
            with self._with_checkpoint(request, digest, content) as here:
                episode = self._workplace.run(here, () if kept is None else (kept,))
            return Answer() if recorded else Answer(without_images(episode))

        answer = answer_of(run)
        return answer if kept is None or kept.recorded is None else kept.recorded

    @contextmanager
    def _with_checkpoint(
        self, request: EpisodeRequest, digest: str, content: Sequence[Any]
    ) -> Iterator[EpisodeRequest]:
        """The request with the driver's checkpoint where it lies here, for so long."""
        if not content:
            yield request
            return
        import ray  # pyright: ignore[reportMissingImports] - an extra

        # The same name for the same content, by which the crew is known that stands here already.
        path = Path(tempfile.gettempdir()) / f"{self._name}-{digest}.npz"
        driver: Any = request.driver
        path.write_bytes(ray.get(content[0]))
        try:
            yield replace(request, driver=replace(driver, checkpoint=path))
        finally:
            path.unlink()


class _Kept(Recorder):
    """Keeps an episode by column, to be written elsewhere."""

    def __init__(self) -> None:
        # No store: where it is written is not here.
        self.space = None
        self.recorded: Recorded | None = None

    def on_end(self, episode: Episode) -> None:
        """Stack the images, which travel as one array then."""
        recorded = recorded_of(episode, self.space)
        arrays = {
            name: rows[:,] if isinstance(rows, Frames) else rows
            for name, rows in recorded.arrays.items()
        }
        self.recorded = replace(recorded, arrays=arrays)


class _Files:
    """The checkpoints of drivers, each put into the object store once."""

    def __init__(self, ray: Any) -> None:
        self._ray = ray
        self._lock = threading.Lock()
        self._held: OrderedDict[str, Any] = OrderedDict()

    def of(self, request: EpisodeRequest) -> tuple[str, Sequence[Any]]:
        """Return the digest of the driver's checkpoint, and what refers to its content, if any."""
        driver: Any = request.driver
        path, digest = getattr(driver, "checkpoint", None), getattr(driver, "digest", None)
        if not (isinstance(path, Path) and isinstance(digest, str)):
            return "", ()
        with self._lock:
            if digest not in self._held:
                self._held[digest] = self._ray.put(np.fromfile(path, np.uint8))
                if len(self._held) > MOST_CHECKPOINTS:
                    self._held.popitem(last=False)
            self._held.move_to_end(digest)
            # In a list it travels as what it is; else it would be fetched for each episode.
            return digest, [self._held[digest]]


def _keep(store: EpisodeStore, recorded: Recorded) -> Answer:
    store.keep(recorded)
    return Answer()


def versions() -> dict[str, str]:
    """Return the versions of the packages that episodes depend on, of those that are there."""
    return {name: metadata.version(name) for name in SAME if _is_installed(name)}


def _is_installed(name: str) -> bool:
    return any(metadata.distributions(name=name))


def _connect(ray: Any, workers: int | None, address: str | None) -> None:
    # Ray would report to its makers otherwise.
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    # What Ray says it will do; without a word it warns that it does not yet.
    os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")
    quiet = {"logging_level": logging.ERROR, "log_to_driver": False}
    try:
        if address is None:
            ray.init("local", num_cpus=workers, include_dashboard=False, **quiet)
        else:
            ray.init(address, **quiet)
    except Exception as error:
        # Ray raises many kinds; of a machine too busy to start one in 30 s the bare one.
        at = "on this machine" if address is None else f"at {address}"
        raise SetupError(
            f"no cluster of Ray {at} ({_lines(error)[0]}); wanted one that `ray start` began, "
            "such as --address auto or HOST:6379"
        ) from error


def _lines(error: BaseException) -> list[str]:
    return str(error).strip().splitlines() or [type(error).__name__]
