"""What is claimed of gates at equal burden goes by the best of what looks at nothing."""

import pytest

from sheath_manip.exceptions import StoreError
from sheath_manip.experiments.claims import judge
from sheath_manip.experiments.takeovers.claims import CLAIMS, fails_more
from sheath_manip.experiments.takeovers.plan import SHARE, TAKEOVERS

TWO_SHARES = {
    "tasks": {
        "driving": {
            "targets": [
                {
                    "axis": SHARE,
                    "value": value,
                    "ways": {
                        "gate": {"scenes": 120},
                        "random-steps": {"fails_more_ci95": [0.2, 0.4]},
                        "every-kth-step": {"fails_more_ci95": [low, 0.3]},
                    },
                }
                for value, low in ((0.05, -0.1), (0.08, 0.05))
            ]
        }
    }
}


def test_the_best_baseline_counts() -> None:
    assert fails_more("driving", SHARE, 0.05, TWO_SHARES) == -0.1
    assert fails_more("driving", SHARE, 0.08, TWO_SHARES) == 0.05


def test_a_claim_holds_where_all_baselines_fail_more() -> None:
    claims = {claim.name: claim for claim in CLAIMS}
    share = claims["driving, 8 % share: baselines fail more by, at least"]
    assert judge(share, TWO_SHARES, "summary.json").holds
    assert judge(claims["driving: failing scenes"], TWO_SHARES, "summary.json").value == 120
    calls = claims["driving, 1 takeovers: baselines fail more by, at least"]
    with pytest.raises(StoreError, match=f"lacks the numbers .*driving at 1 {TAKEOVERS}"):
        judge(calls, TWO_SHARES, "summary.json")
