"""`sheath claims`: whether the numbers in results/ are what was promised."""

from dataclasses import dataclass
from pathlib import Path

from sheath_manip.cli.session import Session
from sheath_manip.experiments.claims import print_claims, verdicts


@dataclass(frozen=True, kw_only=True)
class Claims:
    """Hold every committed result against what is claimed of it."""

    results: Path = Path("results")
    """directory of the experiments' results"""

    def run(self, session: Session) -> int:
        """Print one line a claim; 1 where one does not hold."""
        tasks = session.tasks().values()
        gates = [claim for task in tasks if task.probes for claim in task.probes.claims]
        claims = {task.name: task.claims for task in tasks} | {"gates": gates}
        for task in tasks:
            claims |= {f"{task.name}-{plan}": own for plan, own in task.plan_claims.items()}
        return print_claims(verdicts(self.results, claims), session.out)
