"""Scenes made up for arrays: what is in them, framed and upright; pictures of known truth."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
import tyndall
from tyndall import TransferFunction, estimators, volume_scene

VALUES = np.zeros((12, 10, 8), dtype=np.float32)
VALUES[3:9, 2:8, 2:6] = 2.0


def through_middle(scene: tyndall.Scene, axis: int) -> float:
    """Optical thickness along an axis of the scene, through what the camera looks at."""
    direction = np.eye(3)[axis]
    return float(estimators.optical_thickness(scene, scene["camera.target"] - 100 * direction, direction))


def test_presets_give_the_body_their_optical_thickness() -> None:
    # A cube of edge L: the thickness along an axis is that of the preset.
    cube = np.pad(np.ones((32, 32, 32)), 1)
    for preset, thickness in (("smoke", 12), ("cloud", 24)):
        scene = volume_scene(cube, spacing=0.1, preset=preset)
        assert through_middle(scene, 0) == pytest.approx(thickness, rel=1e-3)
    assert through_middle(volume_scene(cube, optical_thickness=3), 0) == pytest.approx(3, rel=1e-3)


def test_the_axis_that_is_up_points_up_and_the_front_is_in_front() -> None:
    # Dense below, and denser still in front.
    x, y, z = np.indices((8, 8, 8))
    body = np.where(z < 4, 1.0, 0.1) + np.where(y < 4, 4.0, 0.0) + 0.1 * x
    # The same with its axes in other places of the array: to the right, up, towards the viewer; and up, left, towards.
    y_up = body[:, ::-1, :].transpose(0, 2, 1)
    x_up = y_up[::-1].transpose(1, 0, 2)
    for up, array in (("z", body), ("y", y_up), ("x", x_up)):
        scene = volume_scene(array, up=up, view=(0, 0))
        target = np.array(scene["camera.target"])
        assert scene["camera.position"][2] > target[2] + 8

        def thickness(place: list[float], target: np.ndarray = target, scene: tyndall.Scene = scene) -> float:
            return float(estimators.optical_thickness(scene, target + [-50.0, *place], [1, 0, 0]))

        low_back, high_back, low_front = thickness([-2, -2]), thickness([2, -2]), thickness([-2, 2])
        assert high_back < 0.5 * low_back < 0.2 * low_front, up
        right, left = (estimators.optical_thickness(scene, target + [dx, 9, 2], [0, -1, 0]) for dx in (3, -3))
        assert right > left, up


def test_the_whole_box_is_in_the_picture_and_fills_it() -> None:
    for view in ((-30, -15), (0, 0), (75, 60)):
        picture = tyndall.render_volume(
            np.ones((9, 7, 5)), spp=2, view=view, resolution=(80, 45), optical_thickness=50, progress=False
        )
        covered = picture.layers["Transmittance"].squeeze() < 1
        assert not covered[[0, -1]].any() and not covered[:, [0, -1]].any(), view
        assert covered[[4, -5]].any() or covered[:, [5, -6]].any(), view


def test_a_transfer_function_is_in_the_scene_as_it_is() -> None:
    function = TransferFunction([0, 2], extinction=[0, 3], albedo=[[1, 0.5, 0.2], [1, 0.5, 0.2]], emission=[0, 0.5])
    scene = volume_scene(VALUES, spacing=0.5, transfer_function=function, up="y")
    assert scene["volume.0.albedo"] == [1, 0.5, 0.2]
    assert scene["volume.0.emission_per_length"] == [0.5, 0.5, 0.5]
    # 6 voxels of 0.5 at extinction 3, and halves of it on either side.
    assert through_middle(scene, 0) == pytest.approx(9, rel=1e-3)


def test_what_only_glows_has_the_radiance_of_its_line_integral() -> None:
    colours = [[0, 0, 0], [0.5, 0.2, 0.0]], [[0, 0, 0], [0.5, 0, 0]], [[0, 1, 0], [0.4, 0.3, 0]]
    for colour in colours:
        function = TransferFunction([0, 2], extinction=0, emission=colour)
        scene = volume_scene(VALUES, transfer_function=function, up="y", view=(0, 0), resolution=(33, 33))
        scene["light"] = []
        picture = tyndall.render(scene, spp=64, progress=False)
        # Along z through the middle, at the scene's x and y of the target: 4 voxels of 2 and halves beside them.
        row = VALUES[6, 5] / 2
        length = np.trapezoid(np.pad(row, 1)) if hasattr(np, "trapezoid") else np.trapz(np.pad(row, 1))
        expected = length * np.array(colour[1]) + (8 - length) * np.array(colour[0])
        middle, error = picture.image[16, 16], picture.standard_error[16, 16]
        assert np.all(np.abs(middle - expected) < 5 * error + 0.06 * expected.max()), (middle, expected)


def test_xarrays_and_volumes_are_taken_where_they_stand() -> None:
    volume = tyndall.Volume(VALUES, spacing=[1, 2, 3], origin=[10, 20, 30])
    scene = volume_scene(volume, up="y")
    assert np.allclose(scene["camera.target"], [10 + 5.5, 20 + 9, 30 + 10.5])
    classified = volume_scene(volume, up="y", transfer_function=TransferFunction([0, 1], extinction=[0, 1]))
    assert np.allclose(classified["volume.0.file"].index_to_world, volume.index_to_world)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: volume_scene(VALUES, preset="milk"), 'preset: there is no "milk"; there is smoke, cloud, ct'),
        (lambda: volume_scene(VALUES * 0), "density: no value is above 0"),
        (lambda: volume_scene(VALUES - 900, preset="ct"), "transfer_function: makes nothing of the values"),
        (lambda: volume_scene(VALUES[0]), "(X, Y, Z)"),
        (lambda: volume_scene(np.ones((4, 4, 4, 3))), "density: a scalar field"),
        (lambda: volume_scene(VALUES, up="w"), "up: write"),
        (lambda: volume_scene(VALUES, view=(0, 90)), "view: give an elevation"),
        (lambda: volume_scene(VALUES, view=(0, np.nan)), "view: give azimuth and elevation"),
        (lambda: volume_scene(VALUES, optical_thickness=0), "optical_thickness: a number above 0"),
        (lambda: volume_scene(VALUES, resolution=(0, 5)), "resolution: a whole number"),
        (lambda: volume_scene(tyndall.Volume(VALUES), spacing=2), "spacing: a Volume has its own"),
    ],
)
def test_mistakes_are_told_in_one_line(call: Callable[[], object], message: str) -> None:
    with pytest.raises(tyndall.Error) as caught:
        call()
    assert message in str(caught.value) and "\n" not in str(caught.value)
