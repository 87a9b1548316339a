"""robomimic's HDF5: one group an episode, observations by key, and the next ones beside them.

| path in `data/demo_i` | meaning |
|---|---|
| `actions` | (T, a) float32, the action that was chosen for export |
| `requested` | (T, a) float32, what the actor asked for, before the command filter |
| `obs/CAMERA_image`, `obs/features` | (T, ...) before the action |
| `next_obs/...` | (T, ...) after it; the last row is the final observation |
| `rewards`, `states` | (T,), (T, s) |
| `dones` | (T,) int64, 1 at the last step |
| `terminated`, `truncated` | (T,) bool, whether and how the episode ended there |
| `NAME` | every other array of `layout`, by its name there |
| `final_state`, `final_time_s` | after the last action |

`mask/success` lists the episodes that succeeded. The attribute `sheath` of each holds its header,
`sheath_digest` a digest of header and arrays.
"""

from sheath_manip.dataset.exchange.formats import Format
from sheath_manip.dataset.exchange.robomimic_reading import RobomimicFile
from sheath_manip.dataset.exchange.robomimic_writing import write

FORMAT = Format(write, RobomimicFile)
