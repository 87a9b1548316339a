"""The figures of an episode so far, and what is made of them."""

from dataclasses import dataclass

from sheath_manip.tasks.gauze_cutting.geometry import RADIUS_M
from sheath_manip.tasks.gauze_cutting.knife import Knife
from sheath_manip.tasks.gauze_cutting.measures import overlap, path_measures
from sheath_manip.tasks.gauze_cutting.workpiece import Workpiece
from sheath_manip.types import Outcome

STRAY_M = 0.003
"""from the line: more is a cut that ruins the piece"""
TEARING = 0.25
"""strain of an edge; an expert's cut comes to .04 to .18 in tuning scenes"""


@dataclass
class Tally:
    """The figures of an episode that its path does not hold."""

    outcome: Outcome = Outcome.TIME_LIMIT
    strain: float = 0.0
    """the largest so far"""
    freed: bool = False

    def judge(self, astray_m: float, exhausted: bool) -> None:
        """End the episode where it is time, the blade being `astray_m` from the line.

        `exhausted` says whether the spares are used up.
        """
        if self.freed:
            self.outcome = Outcome.SUCCESS
        elif self.strain > TEARING or astray_m > STRAY_M or exhausted:
            self.outcome = Outcome.FAILURE


def metrics_of(tally: Tally, knife: Knife, workpiece: Workpiece) -> dict[str, float]:
    """Return what has been cut, how near to the line, and how roughly."""
    path = path_measures(knife.path_m, RADIUS_M)
    disc = workpiece.disc() if tally.freed else None
    difference, iou = overlap(workpiece.sheet, disc, RADIUS_M)
    return {
        "iou": iou,
        "freed": float(tally.freed),
        "difference_mm2": 1e6 * difference,
        "deviation_mm": 1e3 * path.deviation_m,
        "largest_deviation_mm": 1e3 * path.largest_deviation_m,
        "covered": path.covered,
        "strain": tally.strain,
        "stray_pieces": float(workpiece.stray_pieces()),
        "spares_exhausted": float(knife.exhausted),
    }
