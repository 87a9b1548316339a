import numpy as np
import pytest

from sheath_manip.policies.displacement import displaced

BODY = (slice(27, 36), slice(30, 33))


@pytest.fixture
def images() -> dict[str, np.ndarray]:
    """Random blocks around a body that shimmers by a grey level; the second camera's is bright."""
    rng = np.random.default_rng(0)
    scenes = rng.integers(0, 256, (50, 9, 9, 3), dtype=np.uint8).repeat(7, axis=1).repeat(7, axis=2)
    scenes[:, *BODY] = 50 + rng.integers(0, 2, scenes[:, *BODY].shape)
    bright = scenes.copy()
    bright[:, *BODY] = 200
    return {"top": scenes, "bright": bright}


def test_every_camera_gets_as_many_images_as_asked_for_and_the_same_from_the_same_seed(images):
    moved, again = (displaced(images, np.random.default_rng(1), 80) for _ in range(2))
    assert set(moved) == {"top", "bright"}
    for camera, array in moved.items():
        assert array.shape == (80, 63, 63, 3)
        assert array.dtype == np.uint8
        np.testing.assert_array_equal(array, again[camera])
    other = displaced(images, np.random.default_rng(2), 80)
    assert not np.array_equal(moved["top"], other["top"])


def test_the_body_stays_and_the_scene_is_far_from_every_training_image(images):
    moved = displaced(images, np.random.default_rng(1), 80)
    assert np.isin(moved["top"][:, *BODY], [50, 51]).all()
    assert (moved["bright"][:, *BODY] == 200).all()
    for picture in moved["top"].astype(float):
        assert np.abs(images["top"] - picture).mean(axis=(1, 2, 3)).min() > 25


def test_cameras_are_moved_alike(images):
    moved = displaced(images, np.random.default_rng(1), 80)
    # The cameras differ in the body and where its picture went, which is never into this corner.
    np.testing.assert_array_equal(moved["top"][:, :8, :8], moved["bright"][:, :8, :8])


def test_some_are_turned_and_some_moved_aside():
    # Brighter from left to right: aside it stays so, turned it does not.
    ramp = np.broadcast_to(np.arange(0, 240, 4, dtype=np.uint8)[None, :, None], (60, 60, 3))
    flickering = np.stack([ramp, ramp + np.uint8(18)])
    moved = displaced({"top": flickering}, np.random.default_rng(0), 300)["top"].astype(int)
    aside = np.ptp(moved, axis=1).max(axis=(1, 2)) <= 1
    assert 0.3 < aside.mean() < 0.5
    # Between 12 % and 28 % of 60 pixels of 4 grey levels.
    first = np.sort(moved[aside, 0, 30, 0])
    assert 120 - 4 * 17 <= first[0] < first[-1] <= 138 + 4 * 17


def test_images_that_never_change_stay():
    still = np.full((4, 20, 20, 3), 7, np.uint8)
    assert (displaced({"top": still}, np.random.default_rng(0), 5)["top"] == 7).all()
