"""How a policy for Lift through two cameras is fitted, and its gate."""

from sheath_manip.experiments.study import Study
from tools.outside.fetch_study import FULL
from tools.outside.lift_cameras import LIFT_CAMERAS

PLAN = FULL.changed(
    policy={"name": "spatial-cnn", "settings": {"steps": 400, "batch_size": 64}},
    gate={
        "embedding": "camera-convolutions-whitened",
        "precedent_embedding": "camera-convolutions-whitened",
    },
    schedule={"demonstrations": 8, "calibration": 20, "false_alarm_episodes": 1},
    comparison={"final_episodes": 40},
)
STUDY = Study(LIFT_CAMERAS, plans={"full": PLAN})
