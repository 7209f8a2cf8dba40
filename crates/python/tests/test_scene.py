"""Scenes: dictionaries with the keys of scene files."""

from __future__ import annotations

import copy
import pathlib
import pickle
from typing import Any

import numpy as np
import pytest
import tyndall

Ball = dict[str, Any]


def refusal(scene: Any) -> str:
    with pytest.raises(tyndall.Error) as error:
        tyndall.Scene(scene)
    assert "\n" not in str(error.value)
    return str(error.value)


def test_a_dictionary_is_the_same_scene_as_its_text(ball: Ball) -> None:
    scene = tyndall.Scene(ball)
    assert tyndall.Scene.from_toml(scene.to_toml()).hash == scene.hash
    assert tyndall.Scene(scene.to_dict()).hash == scene.hash
    pathlib.Path("ball.toml").write_text(scene.to_toml())
    assert tyndall.load("ball.toml").hash == scene.hash
    assert repr(scene) == "<tyndall.Scene 20x14, 1 volume, 1 light>"


def test_lists_may_be_single_objects_or_dictionaries_by_name(ball: Ball) -> None:
    expected = tyndall.Scene(ball).hash
    assert tyndall.Scene({**ball, "volume": ball["volume"][0], "light": ball["light"][0]}).hash == expected
    assert (
        tyndall.Scene({**ball, "volume": {"smoke": ball["volume"][0]}, "light": {"sun": ball["light"][0]}}).hash
        == expected
    )
    scene = tyndall.Scene({"type": "scene", **ball, "volume": {"smoke": ball["volume"][0]}})
    assert scene.hash == expected and scene["volume.0.name"] == "smoke"


def test_values_may_be_of_numpy_and_none_is_left_out(ball: Ball) -> None:
    expected = tyndall.Scene(ball).hash
    ball["camera"]["position"] = np.array([0, 0, 4])
    ball["camera"]["vertical_fov"] = np.float32(35)
    ball["film"]["resolution"] = (np.int64(20), 14)
    ball["volume"][0]["name"] = None
    assert tyndall.Scene(ball).hash == expected


def test_values_are_read_and_changed_by_their_path(ball: Ball) -> None:
    scene = tyndall.Scene(ball)
    before = scene.hash
    other = copy.copy(scene)
    scene["volume.0.mu_t"] = 3
    assert scene["volume.0.mu_t"] == 3.0 and scene.hash != before and other.hash == before
    scene["light.1"] = {"type": "sun", "direction": [0, -1, 0], "irradiance": 1}
    assert scene["light.1.type"] == "sun" and "light.2" not in scene
    with pytest.raises(KeyError):
        scene["light.2"]
    with pytest.raises(tyndall.Error, match="camera.vertical_fov: `vertical_fov` must be a number between 0 and 180"):
        scene["camera.vertical_fov"] = 200
    assert scene["camera.vertical_fov"] == 35.0


def test_what_is_wrong_is_told_by_its_keys(ball: Ball) -> None:
    ball["volume"][0]["albdeo"] = ball["volume"][0].pop("albedo")
    assert refusal(ball) == ("volume.0.albdeo: unknown key `albdeo` in [[volume]], did you mean `albedo`?")
    assert "the scene lacks [camera]" in refusal({})
    assert refusal({"camera": {"position": [0, 0, float("nan")], "target": [0, 0, 0]}}).startswith(
        "camera.position: `position[2]` must be finite"
    )
    assert "keys are strings" in refusal({1: 2})
    assert "nothing that a scene holds" in refusal({"camera": object()})
    assert "too large an integer" in refusal({"camera": {"vertical_fov": 1 << 70}})
    assert "is a dictionary" in refusal(3)
    endless: list[Any] = []
    endless.append(endless)
    assert "nested deeper" in refusal({"camera": endless})


def test_a_file_that_is_wrong_is_told_as_the_command_does(ball: Ball) -> None:
    pathlib.Path("a.toml").write_text("camera = { position = [0, 0, 5], traget = [0, 0, 0] }\n")
    with pytest.raises(
        tyndall.Error, match=r"a.toml:1:34: unknown key `traget` in \[camera\], did you mean `target`\?"
    ):
        tyndall.load("a.toml")
    with pytest.raises(OSError, match="there is no such file"):
        tyndall.load("none.toml")
    with pytest.raises(tyndall.Error, match="is not a scene or a volume"):
        pathlib.Path("a.png").write_text("")
        tyndall.load("a.png")


def test_a_volume_stands_where_a_file_would(ball: Ball, blob: np.ndarray) -> None:
    volume = tyndall.Volume(blob)
    ball["volume"] = [{"file": volume, "mu_t": 1, "albedo": 0.5}, {"file": volume, "mu_t": 2, "albedo": 0.5}]
    scene = tyndall.Scene(ball)
    assert list(scene.volumes) == ["<volume 0>"] and scene["volume.1.file"].hash == volume.hash
    hashes = [scene.hash]
    for other in [blob * 2, blob[:, ::-1]]:
        scene["volume.1.file"] = tyndall.Volume(other)
        hashes.append(scene.hash)
    scene["volume.1.file"] = tyndall.Volume(blob, spacing=2)
    assert len({*hashes, scene.hash}) == 4
    scene["volume.1.file"] = volume
    assert scene.hash == hashes[0]
    ball["camera"]["position"] = volume
    assert "camera.position: a Volume stands where the name of a `file` would" in refusal(ball)


def test_fields_may_be_volumes_as_well(ball: Ball, blob: np.ndarray) -> None:
    volume = ball["volume"][0]
    del volume["sphere"]
    volume["file"] = tyndall.Volume(blob, spacing=0.1, origin=-0.7)
    volume["temperature"] = {"file": tyndall.Volume(blob * 3000, spacing=0.1, origin=-0.7)}
    volume["albedo_grid"] = {"file": tyndall.Volume(np.stack([blob] * 3, -1), spacing=0.1, origin=-0.7)}
    dim = tyndall.render(ball, spp=2, progress=False).image.mean()
    volume["emission_scale"] = 100
    assert tyndall.render(ball, spp=2, progress=False).image.mean() > 2 * dim


def test_a_scene_is_made_anew_elsewhere_from_its_pickle(ball: Ball, blob: np.ndarray, tmp_path: pathlib.Path) -> None:
    np.save("blob.npy", blob)
    ball["volume"].append({"file": "blob.npy", "mu_t": 1, "albedo": 0.5})
    ball["volume"].append({"file": tyndall.Volume(blob, spacing="1 mm"), "mu_t": 1, "albedo": 0.5})
    scene = tyndall.Scene(ball)
    assert scene.files == {"blob.npy": tmp_path / "blob.npy"}
    pickled, expected = pickle.dumps(scene), scene.hash
    picture = tyndall.render(scene, spp=1, progress=False).image
    (tmp_path / "blob.npy").unlink()
    copy = pickle.loads(pickled)
    assert copy.hash == expected
    np.testing.assert_array_equal(tyndall.render(copy, spp=1, progress=False).image, picture)


def test_scenes_of_other_renderers_are_opened() -> None:
    pathlib.Path("a.pbrt").write_text(
        'Film "rgb" "integer xresolution" 8 "integer yresolution" 6\nCamera "perspective"\nWorldBegin\n'
        'LightSource "infinite" "rgb L" [1 1 1]\nShape "sphere"\n'
    )
    scene = tyndall.load("a.pbrt", set={"render.spp": 2})
    assert tyndall.render(scene, progress=False).image.shape == (6, 8, 3)


def test_a_frame_of_an_animation_is_a_scene(ball: Ball, blob: np.ndarray) -> None:
    for frame in (1, 2):
        np.save(f"blob.{frame:03}.npy", frame * blob)
    ball["volume"] = [{"file": "blob.###.npy", "mu_t": 1, "albedo": 0.5}]
    pathlib.Path("blob.toml").write_text(tyndall.Scene(ball).to_toml())
    animation = tyndall.load("blob.toml", frame=1)
    first, second = animation.at_frame(1), animation.at_frame(2)
    assert list(second.files) == ["blob.002.npy"] and second.hash != first.hash


def test_a_unit_that_is_not_known_is_told_where_it_matters(ball: Ball) -> None:
    ball["unit"] = "parsec"
    assert tyndall.Scene(ball)["unit"] == "parsec"
    ball["camera"]["position"] = ["3 m", 0, 0]
    assert "`parsec` is no unit of length" in refusal(ball)


def test_without_a_path_it_is_the_built_in_scene() -> None:
    assert repr(tyndall.load(set={"film.resolution": [8, 6]})) == "<tyndall.Scene 8x6, 1 volume, 1 light>"


def test_the_schema_is_json() -> None:
    import json

    assert "camera" in json.loads(tyndall.schema())["properties"]
