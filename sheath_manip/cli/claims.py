"""`sheath claims`: whether the numbers in results/ are what was promised."""

from dataclasses import dataclass
from pathlib import Path

from sheath_manip.cli.session import Session
from sheath_manip.experiments.claims import print_claims, verdicts
from sheath_manip.experiments.takeovers.claims import CLAIMS as TAKEOVERS


@dataclass(frozen=True, kw_only=True)
class Claims:
    """Hold every committed result against what is claimed of it."""

    results: Path = Path("results")
    """directory of the experiments' results"""

    def run(self, session: Session) -> int:
        """Print one line a claim; 1 where one does not hold."""
        studies = session.studies()
        gates = [claim for study in studies if study.probes for claim in study.probes.claims]
        claims = {study.name: study.claims for study in studies}
        claims |= {"gates": gates, "takeovers": TAKEOVERS}
        for study in studies:
            claims |= {f"{study.name}-{plan}": own for plan, own in study.plan_claims.items()}
        return print_claims(verdicts(self.results, claims), session.out)
