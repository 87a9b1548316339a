"""The signals of the table, each made from what a choice names."""

from sheath_manip.signals import MakeEmbedding, SignalChoice
from sheath_manip.signals.joined import JoinedSignal
from sheath_manip.signals.margin import MarginSignal
from sheath_manip.signals.near_precedent import NearPrecedentSignal
from sheath_manip.signals.precedent import PrecedentSignal
from sheath_manip.signals.support import SupportSignal
from sheath_manip.signals.trust import TrustSignal
from sheath_manip.support import make_support

JOINED_WEIGHTS = {"support": 1.0, "precedent": 2.0}
"""AUROC of costly mistakes on driving's tuning scenes, two training runs: .928 and .913, counting
alike .928 and .915; alone the support has .908 and .905, the precedent .918 and .900. Of windows
before failures .974 and .929, counting alike .972 and .928."""
TRUSTED_WEIGHTS = {"support": 1.0, "trust": 4.0, "margin": 2.0}
"""Of the platformer's fatal proposals on tuning stages those below a threshold under which 15, 17.5
and 20 % of all steps lie: .77, .81 and .85; without the margin .76, .79 and .80, trust alone .75,
.78 and .80, and `joined` .65, .69 and .70 (283 proposals, 30 stages)"""


def support(choice: SignalChoice, embedding: MakeEmbedding) -> SupportSignal:
    """The score of the support alone."""
    estimator = make_support(choice.support, **choice.hyperparameters)
    return SupportSignal(embedding(choice.embedding), estimator)


def precedent(choice: SignalChoice, embedding: MakeEmbedding) -> PrecedentSignal:
    """Judge whether the expert ever did as the policy proposes, near this state."""
    return PrecedentSignal(embedding(choice.precedent_embedding))


def joined(choice: SignalChoice, embedding: MakeEmbedding) -> JoinedSignal:
    """Support and precedent."""
    parts = {"support": support(choice, embedding), "precedent": precedent(choice, embedding)}
    return JoinedSignal(parts, JOINED_WEIGHTS)


def trust(choice: SignalChoice, embedding: MakeEmbedding) -> TrustSignal:
    """Judge how much farther states are in which the expert did otherwise."""
    return TrustSignal(embedding(choice.precedent_embedding))


def trust_joined(choice: SignalChoice, embedding: MakeEmbedding) -> JoinedSignal:
    """Support, trust, and by how much the policy prefers its action."""
    parts = {
        "support": support(choice, embedding),
        "trust": trust(choice, embedding),
        "margin": MarginSignal(),
    }
    return JoinedSignal(parts, TRUSTED_WEIGHTS)


def near_precedent(choice: SignalChoice, embedding: MakeEmbedding) -> NearPrecedentSignal:
    """Judge whether the expert did nearly as the policy proposes, for continuous actions."""
    return NearPrecedentSignal(embedding(choice.precedent_embedding))


def near_joined(choice: SignalChoice, embedding: MakeEmbedding) -> JoinedSignal:
    """Support and near precedent, which count alike."""
    return JoinedSignal(
        {"support": support(choice, embedding), "precedent": near_precedent(choice, embedding)}
    )
