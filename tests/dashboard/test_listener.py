import threading
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sheath_manip.dashboard import Dashboard
from sheath_manip.dashboard.chart import chart_of
from sheath_manip.dashboard.drawer import Drawer
from sheath_manip.dashboard.snapshot import Snapshot
from sheath_manip.dashboard.widgets.counts import Counts
from sheath_manip.dashboard.widgets.trouble import Trouble
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.learning.run import LearningRun
from sheath_manip.metrics import record_of
from sheath_manip.protocols import Environment
from sheath_manip.rollout.serial import SerialExecutor
from sheath_manip.types import Actor, Episode, Limited, Outcome, Purpose
from sheath_manip.types.samples import Samples, samples_from
from tests.dashboard.conftest import SPEC, TOKEN, play
from tests.toy import CORRIDOR, PLAN, Corridor
from tests.waiting import DEADLINE_S, eventually


def test_stalled_drawing_never_holds_the_loop(
    dashboard: Dashboard,
    environment: Environment,
    episode: Episode,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    drawing, release = threading.Event(), threading.Event()
    outlasted = []

    def stall(_: object) -> None:
        drawing.set()
        outlasted.append(release.wait(DEADLINE_S))

    monkeypatch.setattr(type(dashboard._page), "watched", True)
    with Dashboard(environment.spec, port=0, token=TOKEN) as quick:
        monkeypatch.setattr(dashboard._page, "draw", stall)
        monkeypatch.setattr(quick._page, "draw", lambda _: None)
        took_s = {dashboard: [], quick: []}
        for listener in took_s:
            listener.on_start(environment, episode.info)
        assert drawing.wait(DEADLINE_S)
        # In turns, so that whatever else runs on the machine holds up both alike.
        for step in episode.steps:
            for listener, times_s in took_s.items():
                began_s = time.perf_counter()
                listener.on_step(environment, step)
                times_s.append(time.perf_counter() - began_s)
        release.set()
    dashboard.close()
    # One drawing that the steps did not wait for.
    assert outlasted[0]
    assert np.median(took_s[dashboard]) < 10 * np.median(took_s[quick])


def steps_noted(dashboard: Dashboard) -> int:
    snapshot = dashboard._latest()
    return 0 if snapshot is None else snapshot.episode.steps


def test_pause_blocks_and_resume_releases(
    dashboard: Dashboard, environment: Environment, episode: Episode
) -> None:
    dashboard.on_start(environment, episode.info)
    dashboard.pause()
    assert dashboard.paused
    stepped = threading.Event()

    def run() -> None:
        dashboard.on_step(environment, episode.steps[0])
        stepped.set()

    thread = threading.Thread(target=run, daemon=True)
    thread.start()
    assert eventually(lambda: steps_noted(dashboard) == 1)
    assert not stepped.wait(0.2)
    dashboard.resume()
    assert stepped.wait(DEADLINE_S)
    thread.join(DEADLINE_S)


def test_a_run_that_is_paused_between_two_episodes_does_not_begin(
    dashboard: Dashboard, environment: Environment, episode: Episode
) -> None:
    dashboard.pause()
    start = (environment, episode.info)
    run = threading.Thread(target=dashboard.on_start, args=start, daemon=True)
    run.start()
    assert eventually(lambda: dashboard._latest() is not None)
    run.join(0.2)
    assert run.is_alive()
    dashboard.resume()
    run.join(DEADLINE_S)
    assert not run.is_alive()


def test_close_releases_a_paused_run(
    dashboard: Dashboard, environment: Environment, episode: Episode
) -> None:
    dashboard.on_start(environment, episode.info)
    dashboard.pause()
    step = (environment, episode.steps[0])
    run = threading.Thread(target=dashboard.on_step, args=step, daemon=True)
    run.start()
    assert eventually(lambda: steps_noted(dashboard) == 1)
    assert run.is_alive()
    dashboard.close()
    run.join(DEADLINE_S)
    assert not run.is_alive()


def test_fit_shows_its_states_in_the_plane(
    dashboard: Dashboard, environment: Environment, episode: Episode
) -> None:
    dashboard.on_start(environment, episode.info)
    features = np.arange(12, dtype=np.float32).reshape(4, 3)
    for states in (features[:2], features):
        dashboard.on_fit(Samples({}, states, np.zeros((len(states), 1), np.float32), np.arange(4)))
        snapshot = dashboard._latest()
        assert snapshot is not None
        assert snapshot.training is not None
        # x_m and y_m are the second and the third feature.
        assert chart_of(SPEC).fit(snapshot.training).tolist() == states[:, 1:].tolist()


def test_page_of_a_learning_run_gets_its_training_states(tmp_path: Path) -> None:
    # A linear policy on pixels: quickly fitted.
    plan = PLAN.changed(
        policy={"name": "hog-svm"}, gate={"signal": "support", "embedding": "pixels"}
    )
    store = EpisodeStore.create(tmp_path / "store")
    with Dashboard(Corridor().spec, port=0, token=TOKEN) as dashboard:
        with SerialExecutor() as executor:
            LearningRun(CORRIDOR, plan, 0, tmp_path, store, executor, (dashboard,)).prepare()
        snapshot = dashboard._latest()
    demonstrations = samples_from(store.episodes(Purpose.DEMONSTRATION))
    assert snapshot is not None
    assert snapshot.training is not None
    assert snapshot.training.features.tolist() == demonstrations.features.tolist()


def test_drawer_outlives_failures(caplog: pytest.LogCaptureFixture) -> None:
    drawn, failures = [], []

    def draw() -> None:
        drawn.append(True)
        if len(drawn) < 4:
            raise ValueError("no ink")

    drawer = Drawer(draw, failures.append, rate_hz=200)
    for count in range(1, 5):
        drawer.wake()
        assert eventually(lambda count=count: len(drawn) == count)
    drawer.close()
    assert failures == ["ValueError: no ink"] * 3
    assert len(caplog.records) == 1
    assert "no ink" in caplog.text


def test_failed_drawing_marks_the_page_and_not_the_run(
    dashboard: Dashboard,
    environment: Environment,
    episode: Episode,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def fail(_: object) -> None:
        raise ValueError("no <ink>")

    trouble = dashboard._page.widget(Trouble)._box
    monkeypatch.setattr(type(dashboard._page), "watched", True)
    with monkeypatch.context() as broken:
        broken.setattr(dashboard._page, "draw", fail)
        dashboard.on_start(environment, episode.info)
        dashboard.on_step(environment, episode.steps[0])
        assert eventually(lambda: trouble.visible and "no &lt;ink&gt;" in trouble.content)
        assert "out of date" in trouble.content
    dashboard.on_step(environment, episode.steps[1])
    assert eventually(lambda: not trouble.visible)


def test_drawer_keeps_its_rate() -> None:
    drawn = []
    rate_hz, count = 40.0, 21
    began_s = time.monotonic()
    drawer = Drawer(lambda: drawn.append(True), pytest.fail, rate_hz)

    def woken_often_enough() -> bool:
        drawer.wake()
        return len(drawn) >= count

    assert eventually(woken_often_enough)
    took_s = time.monotonic() - began_s
    drawer.close()
    # No upper bound: how much later a thread gets its turn is up to the machine.
    assert took_s >= (count - 1) / rate_hz


def test_drawer_draws_only_what_is_new() -> None:
    drawn = []
    drawer = Drawer(lambda: drawn.append(True), pytest.fail, rate_hz=1000)
    drawer.wake()
    assert eventually(lambda: len(drawn) == 1)
    time.sleep(0.05)
    drawer.close()
    assert len(drawn) == 1


def test_tally_counts_interventions_and_outcomes(
    dashboard: Dashboard, environment: Environment, episode: Episode
) -> None:
    for outcome in (Outcome.SUCCESS, Outcome.FAILURE):
        play(dashboard, environment, replace(episode, outcome=outcome))
    snapshot = dashboard._latest()
    assert snapshot is not None
    expert = [step.decision.actor is Actor.EXPERT for step in episode.steps]
    begun = sum(now and not before for before, now in zip([False, *expert], expert, strict=False))
    assert snapshot.episode.takeovers == begun > 1
    assert snapshot.series.takeovers == 2 * begun
    assert snapshot.episode.driving_steps == sum(expert)
    assert snapshot.series.steps == 2 * len(expert)
    assert snapshot.outcomes == {Outcome.SUCCESS: 1, Outcome.FAILURE: 1}
    assert snapshot.outcome is Outcome.FAILURE
    assert len(snapshot.trace) == len(expert)


def test_limited_commands_are_told_and_counted(
    dashboard: Dashboard, environment: Environment, episode: Episode
) -> None:
    counts = dashboard._page.widget(Counts)
    limited = (Limited("<b>speed</b>", 0.25), Limited("workspace", 0.5))
    steps = [
        replace(step, limited=limited if number % 4 == 3 else ())
        for number, step in enumerate(episode.steps[:9])
    ]

    def drawn() -> Snapshot:
        snapshot = dashboard._latest()
        assert snapshot is not None
        counts.draw(snapshot)
        return snapshot

    dashboard.on_start(environment, episode.info)
    drawn()
    assert not counts._limited.visible
    for step in steps[:8]:
        dashboard.on_step(environment, step)
    snapshot = drawn()
    assert snapshot.episode.limited_share == snapshot.series.limited_share == 0.25
    assert snapshot.trace.limited.tolist() == [False, False, False, True] * 2
    assert counts._limited.visible
    assert "&lt;b&gt;speed&lt;/b&gt; 25% · workspace 50%" in counts._limited.content
    assert "25% of this episode" in counts._limited.content
    dashboard.on_step(environment, steps[8])
    drawn()
    assert "not now" in counts._limited.content


def test_demonstration_is_no_intervention(
    dashboard: Dashboard, environment: Environment, episode: Episode
) -> None:
    steps = tuple(replace(step, proposed=None, labelled=step.executed) for step in episode.steps)
    play(dashboard, environment, replace(episode, steps=steps))
    snapshot = dashboard._latest()
    assert snapshot is not None
    assert snapshot.episode.takeovers == 0
    assert snapshot.episode.driving_steps > 0
    assert snapshot.episode.labels == record_of(replace(episode, steps=steps)).queries
