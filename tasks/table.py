"""The table of tasks: a new task is one line here."""

from sheath_manip.task import Task
from sheath_manip.tasks.driving.entry import DRIVING
from sheath_manip.tasks.gauze_cutting.entry import GAUZE_CUTTING
from sheath_manip.tasks.grasp_clutter.entry import GRASP_CLUTTER
from sheath_manip.tasks.platformer.entry import PLATFORMER

TASKS: dict[str, Task] = {
    "driving": DRIVING,
    "gauze-cutting": GAUZE_CUTTING,
    "grasp-clutter": GRASP_CLUTTER,
    "platformer": PLATFORMER,
}
