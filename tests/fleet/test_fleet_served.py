"""One simulated operator serves four robots through the page's own socket."""

from dataclasses import replace

import pytest

from sheath_manip.rollout.asked import asked_in
from sheath_manip.rollout.simulated_operator import OperatorConfig
from sheath_manip.types import Actor, Outcome, Reason
from tests.fleet.drifting import requests, sidestep
from tests.fleet.served import POST, served
from tests.toy import Corridor, MiddleKeeper
from tests.waiting import DEADLINE_S
from tools.fleet_person import Eyes, FleetPerson

ROBOTS, EPISODES, PATIENCE_S = 4, 6, 2.0
QUICK = OperatorConfig(reaction_s=0.1, reaction_spread_s=0.0, attention_s=0.2)


# Four robots, the person and the page's socket each want a part of two cores, and what is judged is
# the time that they take.
@pytest.mark.soak
def test_four_robots_are_served_without_a_failure_and_none_waits_too_long():
    """Each scene is one in which the policy alone fails; so is one robot's without an answer."""
    twin = Corridor(24)
    # Ten steps a second, which a person can follow.
    post = replace(POST, speed=0.2)
    with served(ROBOTS, requests(EPISODES), post, PATIENCE_S) as run:

        def film():
            return run.cockpit.roster.shown.film

        run.begin()
        eyes = Eyes(twin, MiddleKeeper(twin))
        with FleetPerson(run.station, film, eyes, sidestep, QUICK) as person:
            assert run.over.wait(2 * DEADLINE_S), run.words()
    assert [ran.fault for ran in run.ran] == [""] * EPISODES
    assert len({ran.robot for ran in run.ran}) == ROBOTS
    episodes = [ran.episode for ran in run.ran if ran.episode is not None]
    # None at all, so none that one robot alone would not have had.
    assert {each.outcome for each in episodes} == {Outcome.SUCCESS}
    asked = [asked_in(each) for each in episodes]
    assert sum(each.requests for each in asked) >= EPISODES
    steps = [step for each in episodes for step in each.steps]
    assert {Actor.POLICY, Actor.OPERATOR} <= {step.decision.actor for step in steps}
    # To wait costs no step, and no fallback had to act.
    assert not {Reason.WAITING, Reason.NO_ANSWER} & {step.decision.reason for step in steps}
    # The bound that fleet/urgency.py states.
    longest_s = max(step.decision.waited_s for step in steps)
    assert 0 < longest_s <= PATIENCE_S + ROBOTS * max(person.turns_s)
    assert len(person.turns_s) >= EPISODES
