"""What is learned on robosuite's Lift."""

from sheath_manip.experiments.study import Study
from tools.outside.fetch_study import FULL
from tools.outside.lift import LIFT

STUDY = Study(LIFT, plans={"full": FULL})
