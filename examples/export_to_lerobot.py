"""Export to LeRobot, and read it there: what was recorded, as LeRobot's own loader gives it.

    python examples/export_to_lerobot.py STORE DATASET [export_to_lerobot.png]

STORE is one that `examples/roll_out.py` or `sheath collect` records; DATASET must not exist.
LeRobot is an extra, since it wants an older torch: pip install 'sheath-manip[lerobot]'. In the
picture: five frames of the first camera, from DATASET.
"""

import sys
from pathlib import Path

import numpy as np
from PIL import Image

from sheath_manip import EpisodeStore, SheathError
from sheath_manip.dataset.exchange.exporting import export
from sheath_manip.dataset.exchange.selection import Selection


def read(path: Path) -> np.ndarray:
    """Load the dataset with LeRobot; return (h, w, 3) RGB of five frames side by side."""
    # Not among the development packages.
    from lerobot.datasets.lerobot_dataset import (  # pyright: ignore[reportMissingImports]
        LeRobotDataset,
    )

    dataset = LeRobotDataset(f"local/{path.name}", root=path)
    print(f"{dataset.meta.total_episodes} episodes, {len(dataset)} frames at {dataset.fps} Hz")
    camera = dataset.meta.camera_keys[0]
    shown = [dataset[int(index)] for index in np.linspace(0, len(dataset) - 1, 5)]
    for item in shown:
        print(f"{float(item['timestamp']):5.1f} s  action {item['action'].numpy().round(2)}")
    images = [item[camera].numpy().transpose(1, 2, 0) for item in shown]
    return np.concatenate([np.round(255 * image).astype(np.uint8) for image in images], axis=1)


def main(store: str, dataset: str, picture: str = "export_to_lerobot.png") -> int:
    """Write, read and draw; 2 where LeRobot is not there, or STORE is no store."""
    try:
        print(export(EpisodeStore(store), Path(dataset), "lerobot", Selection()))
    except SheathError as error:
        print(error, file=sys.stderr)
        return 2
    Image.fromarray(read(Path(dataset))).resize((1440, 288)).save(picture)
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
