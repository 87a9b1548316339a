"""A person in Chromium behind a slow link with an endless buffer: what it sees is no old film."""

import time

import pytest

from sheath_manip.dashboard import operator_socket
from sheath_manip.dashboard.picture_age import OLDEST_S, PictureAge
from sheath_manip.types import Actor
from tests.cockpit.operated_grasp import operated_grasp
from tests.slow_link import slow_link
from tools.chromium import chromium_page, open_dashboard, wait_until

pytestmark = [pytest.mark.browser, pytest.mark.soak]
SETTLED_S, WATCHED_S = 8.0, 4.0
OLDEST_SHOWN_S = {250e3: 1.0, 60e3: 2.0}
"""by bytes a second"""
JITTER_S = 1.0
"""of a machine that draws in software beside other programs"""


def test_the_picture_is_young_or_the_robot_holds(monkeypatch):
    ages: list[PictureAge] = []

    class Noted(PictureAge):
        def __init__(self) -> None:
            super().__init__()
            ages.append(self)

    monkeypatch.setattr(operator_socket, "PictureAge", Noted)
    with (
        operated_grasp() as grasp,
        slow_link(grasp.page._server.access.port) as link,
        chromium_page() as page,
    ):
        open_dashboard(page, link.address(grasp.page.address))
        page.wait_for_function("window.sheathOperator?.state.operated")
        page.keyboard.press("t")
        wait_until(lambda: grasp.cockpit.state.taken, "takeover", page)
        page.keyboard.down("j")
        for bytes_per_s, oldest_s in OLDEST_SHOWN_S.items():
            link.bytes_per_s = bytes_per_s
            page.wait_for_timeout(1000 * SETTLED_S)
            ended_s, worst_s = time.monotonic() + WATCHED_S, 0.0
            while time.monotonic() < ended_s:
                age_s = ages[-1].age_s
                worst_s = max(worst_s, age_s)
                if age_s > OLDEST_S + 1.0:
                    assert grasp.turns[-1][1] is not Actor.OPERATOR
                page.wait_for_timeout(50)
            print(f"{bytes_per_s:g} bytes a second: at most {worst_s:.2f} s old")
            assert worst_s < oldest_s + JITTER_S
