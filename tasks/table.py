"""The table of tasks: a new task is one line here."""

from sheath_manip.task import TaskEntry
from tasks.driving.entry import DRIVING

TASKS: dict[str, TaskEntry] = {
    "driving": DRIVING,
}
