"""`sheath evaluate`: a policy alone, on scenes that nothing was trained or tuned on."""

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated

from sheath_manip.burden import burden_of
from sheath_manip.cli.computing import Computing
from sheath_manip.cli.options import WITHOUT_PREFIX, TaskName
from sheath_manip.cli.session import Session, at_least_one
from sheath_manip.cli.where import Where
from sheath_manip.files.json_files import plain
from sheath_manip.learning.config import Comparison


@dataclass(frozen=True, kw_only=True)
class Evaluate:
    """Judge a policy alone, without gate and expert, on held-out scenes."""

    task: TaskName
    """name of the task, as `sheath tasks` lists it, or its place, `file.py:TASK`"""
    checkpoint: Path
    """file of the policy, as `sheath train` and `sheath experiment` write it"""
    episodes: int = 20
    """number of scenes"""
    variant: str = "default"
    """variant of the task"""
    scenes: str = Comparison.held_out_set
    """name of the set of scenes; tune on another than you report"""
    computing: Annotated[Computing, WITHOUT_PREFIX] = field(default_factory=Computing)
    where: Annotated[Where, WITHOUT_PREFIX] = field(default_factory=Where)
    json: bool = False
    """print nothing but JSON on the standard output"""

    def run(self, session: Session) -> int:
        """Run the scenes, then print rates and means with their 95 % intervals."""
        self.computing.begin()
        at_least_one("episodes", self.episodes)
        task = session.runnable(self.task)
        # Only now: torch takes seconds to import.
        from sheath_manip.cli.episodes import executor_of, opened, print_figures
        from sheath_manip.learning.checkpoint import digest, load_checkpoint
        from sheath_manip.learning.drivers import PolicyAlone
        from sheath_manip.learning.evaluation import evaluation_requests
        from sheath_manip.metrics import figures_of, record_of

        with opened(task, self.variant) as probe:
            spec = probe.spec
        checkpoint = load_checkpoint(self.checkpoint, spec)
        session.remark(checkpoint.remark)
        requests = evaluation_requests(
            task,
            self.variant,
            spec,
            PolicyAlone(self.checkpoint, digest(self.checkpoint)),
            self.scenes,
            self.episodes,
            method=checkpoint.method,
            number=checkpoint.round,
        )
        with (
            executor_of(self.where) as executor,
            session.progress("held-out scenes", self.episodes) as report,
        ):
            records = [record_of(each) for each in executor.map(requests, report=report)]
        if not self.json:
            print_figures(records, session)
            return 0
        origin = {
            "task": task.name,
            "variant": self.variant,
            "scenes": self.scenes,
            "checkpoint": str(self.checkpoint),
            "digest": digest(self.checkpoint),
        }
        found = asdict(figures_of(records)) | asdict(burden_of(records))
        print(json.dumps(plain(origin | found), indent=1))
        return 0
