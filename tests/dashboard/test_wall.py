"""What the wall's server tells: moments in their order, pictures and clips, and to nobody else."""

import gzip
import http.client
import json
import math
import random
from collections.abc import Iterator
from dataclasses import replace
from http import HTTPStatus
from pathlib import Path
from urllib.parse import urlsplit

import cv2
import numpy as np
import pytest

from sheath_manip.dashboard import Replay
from sheath_manip.dashboard.catalog import EpisodeCatalog
from sheath_manip.dashboard.wall import thumbnails
from sheath_manip.dashboard.wall.ranking import KINDS, Kind, Moment, moments_of
from sheath_manip.dashboard.wall.shelf import Shelf
from sheath_manip.dashboard.wall.thumbnails import FRAMES, Thumbnails
from sheath_manip.dataset.beside import THUMBNAILS
from sheath_manip.dataset.check import check
from sheath_manip.dataset.marks import Marks, Note
from sheath_manip.dataset.moments import EpisodeMoments, NearMiss, Takeover
from sheath_manip.dataset.store import EpisodeStore
from sheath_manip.playback.frames import WIDTH_PX
from sheath_manip.types import Actor, Outcome, Reason
from tests.dashboard.conftest import TOKEN
from tests.dashboard.wall_store import NOTE, STEPS, running_replay, wall_store
from tests.waiting import DEADLINE_S, eventually

FOUND = EpisodeMoments(
    (
        Takeover(2, 4, Reason.OUTSIDE, Actor.EXPERT, -0.5),
        Takeover(8, 9, Reason.RISK, Actor.OPERATOR, math.nan),
    ),
    (NearMiss(6, 0.05),),
)


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> EpisodeStore:
    return wall_store(tmp_path_factory.mktemp("wall") / "store")


@pytest.fixture(scope="module")
def replay(store: EpisodeStore) -> Iterator[Replay]:
    with running_replay(store) as page:
        yield page


def get(replay: Replay, path: str, **headers: str) -> tuple[http.client.HTTPResponse, bytes]:
    """Ask as a browser that was let in, unless other `headers` are given."""
    access = replay._server.access
    connection = http.client.HTTPConnection("127.0.0.1", access.port, timeout=DEADLINE_S)
    try:
        own = {"Cookie": f"sheath={access.cookie}"} | headers
        connection.request("GET", f"{access.path}/wall/{path}", headers=own)
        response = connection.getresponse()
        return response, response.read()
    finally:
        connection.close()


def test_the_worst_comes_first(store: EpisodeStore) -> None:
    summary = EpisodeCatalog(store).summary(0)
    told = {
        outcome: list(moments_of(0, replace(summary, outcome=outcome), Marks(), FOUND))
        for outcome in Outcome
    }
    mixed = [moment for moments in told.values() for moment in moments]
    mixed.append(Moment(1, 3, Kind.TAKEOVER, -2.0))
    mixed += moments_of(2, replace(summary, outcome=Outcome.SUCCESS), noted(), EpisodeMoments())
    random.Random(0).shuffle(mixed)
    ranked = sorted(mixed, key=lambda each: each.rank)
    assert [each.kind for each in ranked] == sorted((each.kind for each in ranked), key=KINDS.index)
    assert [kind.value for kind in KINDS] == [
        "failure", "stuck", "cut short", "takeover in vain", "takeover", "near miss", "mark",
    ]  # fmt: skip
    margins = [each.margin for each in ranked if each.kind is Kind.TAKEOVER]
    known = [each for each in margins if not math.isnan(each)]
    assert known == sorted(known)
    assert known[0] == -2.0
    # What has no score comes after what has one.
    assert margins[: len(known)] == known


def noted() -> Marks:
    return Marks(Outcome.SUCCESS, ((3, 5),), (Note(1, "odd"), Note(10**6, "beyond the end")))


def test_an_episode_that_failed_blames_its_last_takeover(store: EpisodeStore) -> None:
    summary = EpisodeCatalog(store).summary(0)
    for outcome, last in (
        (Outcome.FAILURE, Kind.IN_VAIN),
        (Outcome.TIME_LIMIT, Kind.IN_VAIN),
        (Outcome.SUCCESS, Kind.TAKEOVER),
    ):
        told = moments_of(0, replace(summary, outcome=outcome), Marks(), FOUND)
        taken = [each for each in told if each.reason is not None]
        assert [each.kind for each in taken] == [Kind.TAKEOVER, last]
    marked = list(moments_of(0, summary.marked(noted()), noted(), EpisodeMoments()))
    assert [(each.step, each.text) for each in marked] == [
        (1, "odd"),
        (STEPS - 1, "beyond the end"),
        (3, "not learned from: steps 4 .. 5"),
        (STEPS - 1, "outcome marked: success"),
    ]


def test_moments_are_told_to_who_was_let_in_alone(replay: Replay) -> None:
    for path in ("moments", "now", "strip/0/3", "clip/0/0/9/mp4"):
        assert get(replay, path, Cookie="sheath=1")[0].status == HTTPStatus.UNAUTHORIZED
        assert get(replay, path, Origin="http://evil.example")[0].status == HTTPStatus.FORBIDDEN
        assert get(replay, path, Host="evil.example")[0].status == HTTPStatus.FORBIDDEN
    port = urlsplit(replay.address).port
    connection = http.client.HTTPConnection("127.0.0.1", port or 0, timeout=DEADLINE_S)
    connection.request("GET", "/wall/moments", headers={"Cookie": f"sheath={TOKEN}"})
    assert connection.getresponse().status == HTTPStatus.UNAUTHORIZED
    connection.close()


def test_all_moments_are_told_at_once(replay: Replay) -> None:
    def told() -> dict:
        response, body = get(replay, "moments")
        assert response.getheader("Content-Encoding") == "gzip"
        return json.loads(gzip.decompress(body))

    eventually(lambda: told()["read"] == 4)
    facts = told()
    assert (facts["of"], facts["damaged"]) == (4, 0)
    moments = facts["moments"]
    kinds = [facts["kinds"][code] for code in moments["kind"]]
    assert kinds[:2] == ["failure", "stuck"]
    assert kinds[-1] == "mark"
    assert list(moments["text"].values()) == [NOTE]
    assert {len(moments[name]) for name in ("place", "step", "kind", "margin")} == {len(kinds)}
    assert moments["reason"]["words"] == ["outside support"]
    assert get(replay, "now")[1].startswith(b'{"place": 0')


@pytest.mark.parametrize(
    "path",
    [
        "", "x", "strip/0", "strip/-1/0", "strip/4/0", "strip/0/0/0", "strip/0/..", "strip/a/b",
        "clip/9/0/1/mp4", "clip/0/0/1/html", "clip/0/0/1/mp4/..", "strip/99999999999999/0",
        "../wall/now", "%2e%2e/now", "strip/0/0?x",
    ],
)  # fmt: skip
def test_any_other_path_leads_nowhere(replay: Replay, path: str) -> None:
    assert get(replay, path)[0].status in (HTTPStatus.NOT_FOUND, HTTPStatus.UNAUTHORIZED)


def test_a_strip_is_made_once_and_kept_beside_the_store(
    replay: Replay, store: EpisodeStore
) -> None:
    response, first = get(replay, "strip/0/999999999")
    assert response.status == HTTPStatus.OK
    assert response.getheader("Content-Type") == "image/jpeg"
    picture = cv2.imdecode(np.frombuffer(first, np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    assert picture.shape[1] % FRAMES == 0
    # A step beyond the last one is that.
    assert get(replay, f"strip/0/{STEPS - 1}")[1] == first
    (kept,) = (store.path / THUMBNAILS).iterdir()
    assert kept.read_bytes() == first
    assert check(store) == []
    kept.write_bytes(first[:40])
    assert get(replay, f"strip/0/{STEPS - 1}")[1] == first


def test_a_strip_of_another_episode_of_the_same_name_is_another(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = wall_store(tmp_path / "store")
    name = store.names()[0]
    made = Thumbnails(EpisodeCatalog(store))
    made.strip(0, 3)
    monkeypatch.setattr(thumbnails, "glimpses", lambda *_: [{}] * FRAMES)
    assert made.strip(0, 3)
    whole = store.read(name)
    store.drop(name)
    store.append(replace(whole, outcome=Outcome.ERROR))
    assert made.strip(0, 3) == b""


def test_a_link_in_place_of_the_pictures_is_not_followed(tmp_path: Path) -> None:
    store, elsewhere = wall_store(tmp_path / "store"), tmp_path / "elsewhere"
    elsewhere.mkdir()
    (store.path / THUMBNAILS).symlink_to(elsewhere)
    assert Thumbnails(EpisodeCatalog(store)).strip(0, 3)
    assert not list(elsewhere.iterdir())


@pytest.mark.parametrize("kind", ["mp4", "gif"])
def test_a_clip_is_made_while_one_asks_for_it(replay: Replay, kind: str, tmp_path: Path) -> None:
    path = f"clip/1/50/9999/{kind}"
    assert get(replay, path)[0].status == HTTPStatus.ACCEPTED
    eventually(lambda: get(replay, path)[0].status == HTTPStatus.OK)
    response, content = get(replay, path)
    name = f"steps-51-{STEPS}.{kind}"
    assert name in (response.getheader("Content-Disposition") or "")
    file = tmp_path / name
    file.write_bytes(content)
    film = cv2.VideoCapture(str(file))
    assert film.get(cv2.CAP_PROP_FRAME_WIDTH) >= WIDTH_PX == 720
    film.release()


def test_moments_of_several_stores_and_new_marks(tmp_path: Path) -> None:
    stores = [wall_store(tmp_path / name) for name in ("one", "two")]
    catalog = EpisodeCatalog(*stores)
    shelf = Shelf(catalog)
    try:
        eventually(lambda: json.loads(gzip.decompress(shelf.told()))["read"] == 8)
        before = shelf.ranked()
        assert {each.place for each in before} == set(range(8))
        catalog.mark(7, Marks(Outcome.FAILURE))
        assert len(shelf.ranked()) == len(before) + 2
        assert [each.kind for each in shelf.ranked()[:3]] == [Kind.FAILURE] * 3
        told = json.loads(gzip.decompress(shelf.told()))
        assert len(told["moments"]["place"]) == len(before) + 2
        assert stores[1].marks(catalog.source(7)[1]).outcome is Outcome.FAILURE
    finally:
        shelf.close()
