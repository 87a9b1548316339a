"""The house's own tasks and studies, and those that installed packages add."""

from sheath_manip.experiments.study import Study
from sheath_manip.registry import Registry
from sheath_manip.task import Task

_HERE = "sheath_manip.tasks"

TASKS: Registry[Task] = Registry(
    "task",
    "sheath.tasks",
    {
        "driving": f"{_HERE}.driving.entry:DRIVING",
        "gauze-cutting": f"{_HERE}.gauze_cutting.entry:GAUZE_CUTTING",
        "grasp-clutter": f"{_HERE}.grasp_clutter.entry:GRASP_CLUTTER",
        "platformer": f"{_HERE}.platformer.entry:PLATFORMER",
    },
    of=Task,
)
STUDIES: Registry[Study] = Registry(
    "study",
    "sheath.studies",
    {
        "driving": f"{_HERE}.driving.study.entry:STUDY",
        "gauze-cutting": f"{_HERE}.gauze_cutting.study.entry:STUDY",
        "grasp-clutter": f"{_HERE}.grasp_clutter.study.entry:STUDY",
        "platformer": f"{_HERE}.platformer.study.entry:STUDY",
    },
    of=Study,
)
"""by the name of their task"""
