"""Films of real episodes: in the scene that they were recorded in, as files that stand alone."""

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from sheath_manip.cli.entry import run_command
from sheath_manip.cli.session import Catalog
from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.exceptions import ParameterError, StoreError, UnknownNameError
from sheath_manip.playback.film import film_of
from sheath_manip.playback.making import FilmMaker, exported
from sheath_manip.playback.page import html
from sheath_manip.protocols import Restorable, Viewable
from sheath_manip.tasks.platformer.entry import PLATFORMER
from sheath_manip.types import Episode, EpisodeInfo, Outcome, Purpose, SceneGeom
from tests.dashboard.conftest import RingRoad, drive
from tests.episodes import episode_of

STEPS = 25


def recorded(run_seed: int) -> tuple[Episode, Sequence[SceneGeom]]:
    """The first steps on the stage of that training run, and what was to be seen there."""
    environment = PLATFORMER.make_for_run("stage", run_seed)
    assert isinstance(environment, Restorable)
    assert isinstance(environment, Viewable)
    info = EpisodeInfo("platformer", 3, Purpose.DEMONSTRATION, 24.0, run_seed=run_seed)
    try:
        observation = environment.reset(info.seed)
        whole = drive(RingRoad(), STEPS)
        steps = []
        for step in whole.steps:
            action = np.array([0, 1, 0, 0], np.float32)
            steps.append(
                replace(
                    step,
                    observation=observation,
                    state=environment.state(),
                    proposed=action,
                    executed=action,
                )
            )
            observation = environment.step(action).observation
        episode = replace(
            whole,
            info=info,
            steps=tuple(steps),
            final_observation=observation,
            final_state=environment.state(),
        )
        return episode, list(environment.scene())
    finally:
        environment.close()


def same(left: Sequence[SceneGeom], right: Sequence[SceneGeom]) -> bool:
    return all(
        np.array_equal(a.size, b.size) and np.array_equal(a.position_in_body, b.position_in_body)
        for a, b in zip(left, right, strict=True)
    )


def catalogued(path: Path, *episodes: Episode) -> EpisodeCatalog:
    store = EpisodeStore.create(path)
    for episode in episodes:
        store.append(episode)
    return EpisodeCatalog(store)


def of_variant(episode: Episode, variant: str) -> Episode:
    return replace(episode, info=replace(episode.info, variant=variant))


# Old recordings do not say their variant, so that the person must.
@pytest.mark.parametrize(("told", "asked"), [("stage", None), ("", "stage")])
def test_an_episode_is_shown_on_the_stage_of_its_own_run(tmp_path, told, asked) -> None:
    shown = {seed: recorded(seed) for seed in (4, 5)}
    episodes = [of_variant(episode, told) for episode, _ in shown.values()]
    catalog = catalogued(tmp_path / "store", *episodes)
    maker = FilmMaker(PLATFORMER, asked, catalog.read, catalog.summary)
    for place, (episode, scene) in enumerate(shown.values()):
        film = maker.film(place)
        assert same(film.scene, scene)
        assert len(film) == STEPS
        way = film.trace.so_far().tool_m
        assert np.isfinite(way).all()
        assert way[-1, 0] > way[0, 0]
        assert film.outcome is episode.outcome
    assert not same(shown[4][1], shown[5][1])
    maker.close()

    replay = ["replay", tmp_path / "store", *(["--variant", asked] if asked else [])]
    for rest in (
        ["--once", "--speed", "100", "--port", "0"],
        ["--export", tmp_path / "episode.html"],
    ):
        argv = [str(word) for word in (*replay, *rest)]
        assert run_command(lambda: Catalog({"platformer": PLATFORMER}, {}), argv) == 0
    assert (tmp_path / "episode.html").stat().st_size < 500_000


def test_an_episode_of_another_task_is_refused(tmp_path) -> None:
    catalog = catalogued(tmp_path, episode_of("pe"))
    maker = FilmMaker(PLATFORMER, None, catalog.read, catalog.summary)
    with pytest.raises(StoreError, match="is of task 'toy'"):
        maker.film(0)
    maker.close()


def test_an_episode_that_does_not_fit_its_variant_is_refused(tmp_path) -> None:
    episode, _ = recorded(4)
    info = replace(episode.info, control_rate_hz=12.0, variant="stage")
    catalog = catalogued(tmp_path, replace(episode, info=info))
    maker = FilmMaker(PLATFORMER, None, catalog.read, catalog.summary)
    with pytest.raises(StoreError, match=r"fit variant 'stage' .*12 Hz instead of 24 Hz"):
        maker.film(0)
    maker.close()


def test_a_variant_that_is_no_longer_there_is_named(tmp_path) -> None:
    catalog = catalogued(tmp_path, of_variant(recorded(4)[0], "moon"))
    maker = FilmMaker(PLATFORMER, None, catalog.read, catalog.summary)
    with pytest.raises(UnknownNameError, match="moon"):
        maker.film(0)
    maker.close()


def test_a_video_has_a_frame_for_each_step_and_its_end_and_a_page_holds_all_of_it(tmp_path) -> None:
    film = film_of(RingRoad(), replace(drive(RingRoad(), 30), outcome=Outcome.SUCCESS))
    name, video = exported(film, None, "mp4")
    assert name == "learning-sheath-s0-r02-i000-seed1.mp4"
    (tmp_path / name).write_bytes(video)
    capture = cv2.VideoCapture(str(tmp_path / name))
    frames = 0
    while capture.read()[0]:
        frames += 1
    capture.release()
    # One more than there are steps: the last is the last observation.
    assert frames == 31
    page = html(film, video)
    # A task called "ring <b>road</b>" is text in the page and in its script.
    assert "<b>" not in page
    assert "ring &lt;b&gt;road&lt;/b&gt;" in page
    assert not re.search(r'(src|href)="(?!data:)', page)
    found = re.search(r'type="application/json">(.*?)</script>', page)
    assert found is not None
    facts = json.loads(found[1])
    assert len(facts["kind"]) == len(facts["score"]) == 30
    assert facts["task"] == "ring <b>road</b>"
    assert [(t["start"], t["stop"]) for t in facts["turns"]] == film.trace.so_far().turns


def test_what_cannot_be_exported_is_said() -> None:
    film = film_of(RingRoad(), drive(RingRoad(), 3))
    with pytest.raises(ParameterError, match="mp4 or html"):
        exported(film, None, "gif")
    for step in list(film.steps):
        film.steps[film.steps.index(step)] = replace(
            step, observation=replace(step.observation, images={})
        )
    with pytest.raises(ParameterError, match="no camera"):
        exported(film, None, "mp4")
