"""What learning may ask of the expert, held against made-up results."""

import pytest

from sheath_manip.experiments.asked_claims import CLAIMS
from sheath_manip.experiments.claims import judge


def method(failed: float, labels: float, share: float, takeovers: float, alone) -> dict:
    last = {
        "expert_share": share,
        "takeovers_an_episode": takeovers,
        "takeovers_a_minute": 4 * takeovers,
        "policy": {"ci95": {"failure_rate": alone}},
    }
    first = {"expert_share": 1.0, "takeovers_an_episode": 9.0, "takeovers_a_minute": 36.0}
    overall = {"failure_rate": failed, "labels_an_episode": labels}
    return {"overall": overall, "rounds": [first, last]}


def result(failed=0.01, own_labels=20.0, share=0.05, takeovers=0.8, own_alone=(0.0, 0.2)) -> dict:
    return {
        "expert": {"failure_rate": 0.0},
        "methods": {
            "dagger": method(0.2, 100.0, 0.0, 0.0, (0.0, 0.1)),
            "sheath": method(failed, 100.0, share, takeovers, (0.0, 0.1)),
            "sheath-own-labels": method(failed, own_labels, share, takeovers, own_alone),
        },
    }


def broken(summary: dict) -> list[str]:
    return [claim.name for claim in CLAIMS if not judge(claim, summary, "made up").holds]


def test_only_the_last_round_is_held_to_the_burden():
    assert broken(result()) == []


@pytest.mark.parametrize(
    ("worse", "name"),
    [
        ({"failed": 0.03}, "SHEATH's executed failure rate, 1.5 times the expert's and 2 points"),
        ({"share": 0.09}, "expert's share in the last round"),
        ({"own_labels": 30.0}, "labels with own labels, a share of DAgger's"),
        (
            {"own_alone": (0.2, 0.5)},
            "last policy alone with own labels fails, low end of the interval; DAgger's high end",
        ),
    ],
)
def test_each_bar_can_break(worse, name):
    assert broken(result(**worse)) == [name]


def test_requests_are_counted_by_the_episode_and_by_the_minute():
    assert broken(result(takeovers=1.5)) == ["requests a minute in the last round"]
    assert broken(result(takeovers=2.5)) == [
        "requests an episode in the last round",
        "requests a minute in the last round",
    ]


def test_an_expert_that_fails_itself_is_no_reproach():
    summary = result(failed=0.05)
    summary["expert"]["failure_rate"] = 0.02
    assert broken(summary) == []
