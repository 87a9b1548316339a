"""`python -m sheath_manip.tasks.gauze_cutting VERB`: the verbs of `sheath`, for this task."""

import sys

from sheath_manip.command import task_main

if __name__ == "__main__":
    sys.exit(task_main("gauze-cutting"))
