"""What a task looks like from the tool: the plane that it moves in, turned as it heads.

A line to be followed looks the same from the tool wherever it is and whichever way it goes, so what
is learned in one place holds in all others. On the gauze, cloned from the same 30 disturbed
demonstrations, a prototype that looked so cut out 12 of 12 discs of tuning scenes, and 3 when it
looked at the whole image.
"""

from dataclasses import replace

import cv2
import numpy as np
from numpy.typing import NDArray

from sheath_manip.exceptions import ParameterError
from sheath_manip.types import ActionSpec, TaskSpec
from sheath_manip.types.samples import Samples

MOST_SIDE_PX = 1024
"""of the image: no memory is taken for more, whatever a checkpoint says"""


class ToolView:
    """Translates observations and actions of a task into the tool's frame, and actions back."""

    def __init__(self, spec: TaskSpec, side_px: int = 64, px_m: float = 0.0008) -> None:
        """Store what is looked at; ParameterError for a task without a tool in a plane.

        Args:
            spec: of the task, with a `tool_frame`.
            side_px: of the square image, in whose middle the tool is. The tool heads to the right;
                what lies to its left is below.
            px_m: side of a pixel in the plane.
        """
        frame = spec.tool_frame
        if frame is None:
            raise ParameterError(
                f"task {spec.name!r} has no tool frame, from which a policy could look; "
                "wanted one such as gauze-cutting, or the policy 'spatial-cnn'"
            )
        if not 1 <= side_px <= MOST_SIDE_PX or not px_m > 0:
            raise ParameterError(
                f"side_px is {side_px} and px_m {px_m}; wanted 1 .. {MOST_SIDE_PX}, like 64, and "
                "more than 0, like .0008"
            )
        self.frame = frame
        self.side_px = side_px
        middle = (side_px - 1) / 2
        self._plane_of_px = np.array(
            [[px_m, 0, -px_m * middle], [0, px_m, -px_m * middle], [0, 0, 1]]
        )
        names = spec.feature_names
        self._position = [names.index(name) for name in frame.position]
        self._heading = [names.index(name) for name in frame.heading]
        placed = {*self._position, *self._heading}
        self._others = [index for index in range(len(names)) if index not in placed]
        self._vector = [spec.action.names.index(name) for name in frame.vector]
        self.spec = replace(
            spec,
            cameras={frame.camera: (side_px, side_px)},
            feature_names=tuple(names[index] for index in self._others),
            action=self._turnable(spec.action),
            plane=None,
            tool_frame=None,
        )
        """of what is seen from the tool"""

    def images(self, images: NDArray[np.uint8], features: NDArray) -> NDArray[np.uint8]:
        """Return (n, side_px, side_px, 3) of the camera's (n, h, w, 3) and (n, f) features."""
        seen = np.empty((len(images), self.side_px, self.side_px, 3), np.uint8)
        tool_in_world = np.zeros((len(images), 3, 3))
        tool_in_world[:, :2, :2] = self._rotations(features)
        tool_in_world[:, :2, 2] = features[:, self._position]
        tool_in_world[:, 2, 2] = 1
        warps = self.frame.px_of_plane @ tool_in_world @ self._plane_of_px
        for index, (image, warp) in enumerate(zip(images, warps, strict=True)):
            seen[index] = cv2.warpPerspective(
                image,
                warp,
                (self.side_px, self.side_px),
                flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP,
                borderMode=cv2.BORDER_REPLICATE,
            )
        return seen

    def features(self, features: NDArray) -> NDArray[np.float32]:
        """Return (n, f') of (n, f), those that say neither where the tool is nor how it heads."""
        return np.ascontiguousarray(features[:, self._others], np.float32)

    def actions(self, actions: NDArray, features: NDArray) -> NDArray[np.float32]:
        """(n, a) actions of the task in the tool's frame."""
        return self._turned(actions, np.swapaxes(self._rotations(features), 1, 2))

    def actions_in_world(self, actions: NDArray, features: NDArray) -> NDArray[np.float32]:
        """(n, a) actions in the tool's frame as the task's."""
        return self._turned(actions, self._rotations(features))

    def samples(self, samples: Samples) -> Samples:
        """Return the same states and labels, seen from the tool."""
        camera = self.frame.camera
        return replace(
            samples,
            images={camera: self.images(samples.images[camera], samples.features)},
            features=self.features(samples.features),
            labels=self.actions(samples.labels, samples.features),
        )

    def _rotations(self, features: NDArray) -> NDArray[np.float64]:
        """(n, 2, 2) from the tool's frame to the world's."""
        cos, sin = np.asarray(features, np.float64)[:, self._heading].T
        return np.stack([np.stack([cos, -sin], axis=1), np.stack([sin, cos], axis=1)], axis=1)

    def _turned(self, actions: NDArray, rotations: NDArray) -> NDArray[np.float32]:
        turned = np.array(actions, np.float32)
        if self._vector:
            vectors = np.einsum("nij,nj->ni", rotations, turned[:, self._vector])
            turned[:, self._vector] = vectors
        return turned

    def _turnable(self, action: ActionSpec) -> ActionSpec:
        """Return bounds that hold whichever way the vector of an admissible action is turned."""
        minimum, maximum = action.minimum.copy(), action.maximum.copy()
        if self._vector:
            largest = np.maximum(-minimum, maximum)[self._vector]
            length = np.float32(np.linalg.norm(largest))
            minimum[self._vector], maximum[self._vector] = -length, length
        return replace(action, minimum=minimum, maximum=maximum)
