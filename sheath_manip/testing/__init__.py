"""Contract suites for members of the tables, as scikit-learn checks estimators.

Each takes a member, or what makes one, and raises AssertionError with a sentence that says what the
contract wants. They want no test framework:

    from sheath_manip.testing import check_policy

    check_policy(lambda spec, seed: MyPolicy(spec, seed=seed), spec)
"""

from sheath_manip.testing.embeddings import check_embedding
from sheath_manip.testing.environments import check_environment, check_task
from sheath_manip.testing.experts import check_expert
from sheath_manip.testing.gates import check_gate
from sheath_manip.testing.policies import check_policy
from sheath_manip.testing.signals import check_signal
from sheath_manip.testing.states import drawn_states
from sheath_manip.testing.supports import check_support

__all__ = [
    "check_embedding",
    "check_environment",
    "check_expert",
    "check_gate",
    "check_policy",
    "check_signal",
    "check_support",
    "check_task",
    "drawn_states",
]
