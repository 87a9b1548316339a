"""What policies of the house want of a task, and what there is where a task has it not."""

from sheath_manip.exceptions import ParameterError
from sheath_manip.types import TaskSpec

OWN_POLICY = "or one of your own: --policy.name, docs/own/policy.md"


def require_camera(spec: TaskSpec) -> None:
    """Raise ParameterError where the task has no camera."""
    if not spec.cameras:
        raise ParameterError(
            f"task {spec.name!r} has no camera; an image policy needs one. With features alone, "
            f"mlp does without, {OWN_POLICY}"
        )


def require_continuous(spec: TaskSpec) -> None:
    """Raise ParameterError where the task's actions are choices."""
    if spec.action.choices is not None:
        raise ParameterError(
            f"task {spec.name!r} has a list of admissible actions; wanted continuous ones to "
            f"regress. For choices there are cnn and hog-svm, {OWN_POLICY}"
        )


def require_features(spec: TaskSpec) -> None:
    """Raise ParameterError where the task has no features."""
    if not spec.feature_names:
        raise ParameterError(
            f"task {spec.name!r} has no features; wanted some to look at. With cameras, cnn or "
            f"spatial-cnn does without, {OWN_POLICY}"
        )
