"""The few interfaces: what a task, expert, policy, support, gate and listener must offer."""

from sheath_manip.protocols.acting import (
    Expert,
    Follows,
    HasOwnFrame,
    Policy,
    Replans,
    TakesOver,
    Teleop,
)
from sheath_manip.protocols.environment import (
    Environment,
    Holds,
    Restorable,
    Viewable,
    require_restorable,
)
from sheath_manip.protocols.judging import Gate, Judge
from sheath_manip.protocols.learning import (
    Agreement,
    Arrays,
    Embedding,
    HasFloor,
    HasParts,
    HasPrecedents,
    PredictingPolicy,
    Reader,
    Refits,
    Signal,
    SupportEstimator,
    TrainablePolicy,
)
from sheath_manip.protocols.listening import (
    HeadwayListener,
    Keeps,
    Listener,
    Report,
    WorkListener,
)

__all__ = [
    "Agreement",
    "Arrays",
    "Embedding",
    "Environment",
    "Expert",
    "Follows",
    "Gate",
    "HasFloor",
    "HasOwnFrame",
    "HasParts",
    "HasPrecedents",
    "HeadwayListener",
    "Holds",
    "Judge",
    "Keeps",
    "Listener",
    "Policy",
    "PredictingPolicy",
    "Reader",
    "Refits",
    "Replans",
    "Report",
    "Restorable",
    "Signal",
    "SupportEstimator",
    "TakesOver",
    "Teleop",
    "TrainablePolicy",
    "Viewable",
    "WorkListener",
    "require_restorable",
]
