from collections.abc import Mapping

import pytest

from sheath_manip.types import TaskSpec
from tasks.table import TASKS
from tests.toy import Corridor


@pytest.fixture(scope="session")
def specs() -> Mapping[str, TaskSpec]:
    """What every task looks like, and the toy one."""
    found = {"corridor": Corridor().spec}
    for name, task in TASKS.items():
        environment = task.make()
        found[name] = environment.spec
        environment.close()
    return found
