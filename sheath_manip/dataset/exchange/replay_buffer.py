"""diffusion_policy's and UMI's ReplayBuffer: all episodes end to end in zarr arrays.

| array | meaning |
|---|---|
| `data/action` | (N, a) float32, the action that was chosen for export |
| `data/requested` | (N, a) float32, what the actor asked for, before the command filter |
| `data/image_CAMERA` | (N, h, w, 3) uint8 |
| `data/NAME` | every other array of `layout`, by its name there |
| `data/limited` | (N, l) float64 where a limit acted anywhere: by how much, by limit; else NaN |
| `meta/episode_ends` | (E,) int64, the number of steps up to and with each episode |
| `meta/final_NAME` | (E, ...) what was observed after each episode's last action |
| `meta/terminated`, `meta/truncated`, `meta/success` | (E,) bool |

It is written in zarr's format 2, and read in 2 and 3. Their readers are of zarr 2, take the arrays
in `data` for as long as the last of `episode_ends`, and want both groups flat. The attribute
`sheath` holds the header and the digest of each episode, and names the columns of `data/limited`.
"""

from sheath_manip.dataset.exchange.formats import Format
from sheath_manip.dataset.exchange.replay_buffer_reading import ReplayBufferFile
from sheath_manip.dataset.exchange.replay_buffer_writing import write

FORMAT = Format(write, ReplayBufferFile)
