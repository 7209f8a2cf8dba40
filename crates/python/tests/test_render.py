"""Rendering: the command's bits, until something says stop."""

from __future__ import annotations

import pathlib
import pickle
import subprocess
import sys
import textwrap
import threading
import time
from typing import Any

import numpy as np
import pytest
import tyndall

Ball = dict[str, Any]


@pytest.fixture
def endless(ball: Ball) -> Ball:
    """A scene that takes minutes."""
    ball["film"]["resolution"] = [256, 256]
    ball["volume"][0].update(mu_t=100, albedo=0.999)
    ball["render"] = {"spp": 100_000}
    return ball


def test_a_picture_has_its_error_and_layers(ball: Ball) -> None:
    picture = tyndall.render(ball, spp=32, progress=False)
    assert picture.image.shape == picture.standard_error.shape == (14, 20, 3)
    assert picture.image.dtype == np.float32
    assert picture.samples == 32 and picture.complete and picture.seconds > 0
    assert picture.layers["Albedo"].shape == (14, 20, 3) and picture.layers["Depth"].shape == (14, 20)
    assert {"A", "Transmittance", "SampleCount", "Single", "Multiple"} <= set(picture.layers)
    assert (picture.layers["SampleCount"] == 32).all()
    # The background is known at once, the ball is not.
    assert picture.image[0, 0].tolist() == [1, 1, 1] and picture.standard_error[0, 0].max() == 0
    assert picture.standard_error[7, 10].min() > 0
    assert 0 < picture.median_error < 0.2
    assert repr(picture).startswith("<tyndall.Render 20x14, 32 samples a pixel, median error")


def test_the_bits_are_those_of_the_command(ball: Ball, command: str) -> None:
    pathlib.Path("ball.toml").write_text(tyndall.Scene(ball).to_toml())
    for options, arguments in [
        ({"spp": 24}, ["--spp", "24"]),
        ({"spp": 5, "seed": 7, "threads": 1}, ["--spp", "5", "--seed", "7"]),
        ({"samples": (3, 9)}, ["--samples", "3..9"]),
    ]:
        subprocess.run(
            [command, "render", "ball.toml", "-o", "a.acc", "-o", "a.exr", *arguments], check=True, capture_output=True
        )
        theirs = tyndall.Accumulation.read("a.acc")
        ours = tyndall.render("ball.toml", progress=False, **options).accumulation
        assert ours == theirs, arguments
        np.testing.assert_array_equal(ours.image, theirs.image)


def test_a_bare_volume_is_rendered_as_the_command_does(blob: np.ndarray, command: str) -> None:
    np.save("blob.npy", blob)
    small = ["--resolution", "16x12", "--spp", "2", "-o", "a.acc"]
    subprocess.run([command, "render", "blob.npy", *small], check=True, capture_output=True)
    theirs = tyndall.Accumulation.read("a.acc")
    for scene in [tyndall.load("blob.npy"), tyndall.Scene.of_volume(tyndall.Volume(blob))]:
        scene["film.resolution"] = [16, 12]
        picture = tyndall.render(scene, spp=2, progress=False)
        np.testing.assert_array_equal(picture.image, theirs.image)
        assert any("chosen from the data" in note for note in scene.notes)


def test_samples_in_parts_are_the_whole(ball: Ball) -> None:
    def part(*samples: int) -> tyndall.Accumulation:
        return tyndall.render(ball, samples=samples, progress=False).accumulation

    whole = tyndall.render(ball, spp=9, progress=False).accumulation
    merged = part(4, 9)
    merged.merge(part(0, 1))
    assert merged.samples == [(0, 1), (4, 9)] and merged != whole
    merged += part(1, 4)
    assert merged.samples == [(0, 9)] and merged == whole
    np.testing.assert_array_equal(merged.image, whole.image)
    np.testing.assert_array_equal(merged.standard_error, whole.standard_error)


def test_sums_survive_bytes_pickles_and_files(ball: Ball) -> None:
    sums = tyndall.render(ball, spp=3, progress=False).accumulation
    sums.save("a.acc")
    for copy in [
        tyndall.Accumulation.from_bytes(sums.to_bytes()),
        pickle.loads(pickle.dumps(sums)),
        tyndall.Accumulation.read("a.acc"),
    ]:
        assert copy == sums and copy.seconds == sums.seconds


def test_sums_that_do_not_belong_together_are_refused(ball: Ball) -> None:
    sums = tyndall.render(ball, spp=2, progress=False).accumulation
    with pytest.raises(tyndall.Error, match=r"both hold samples 0..2"):
        sums.merge(tyndall.render(ball, spp=4, progress=False).accumulation)
    with pytest.raises(tyndall.Error, match="another seed"):
        sums.merge(tyndall.render(ball, samples=(2, 4), seed=1, progress=False).accumulation)
    ball["volume"][0]["mu_t"] = 3
    with pytest.raises(tyndall.Error, match="another scene"):
        sums.merge(tyndall.render(ball, samples=(2, 4), progress=False).accumulation)
    with pytest.raises(tyndall.Error, match="merged with itself"):
        sums.merge(sums)
    assert sums.samples == [(0, 2)]
    with pytest.raises(tyndall.Error, match="is no .acc file"):
        tyndall.Accumulation.from_bytes(b"nothing")
    with pytest.raises(tyndall.Error, match="damaged or cut short"):
        tyndall.Accumulation.from_bytes(sums.to_bytes()[:-9])


def test_a_render_ends_at_its_error_or_time(ball: Ball) -> None:
    picture = tyndall.render(ball, error="5%", progress=False)
    assert picture.median_error <= 0.05 and picture.samples < 2000
    assert tyndall.render(ball, error=1e-9, time=0.2, progress=False).complete


def test_what_few_pixels_have_seen_and_what_the_film_cannot_hold_is_told(ball: Ball) -> None:
    # Glass about a lamp: only chance finds it, one path in 1300.
    lamp = {"sphere": {"center": [0, 9, 0], "radius": 0.25}, "material": {"type": "diffuse", "reflectance": 0}}
    scene = {
        "camera": {"position": [0, 6, 0], "target": [0, 0, 0], "up": [0, 0, 1]},
        "film": {"resolution": [32, 18]},
        "light": [{"type": "constant", "radiance": 1}],
        "shape": [
            {"rectangle": {"corner": [-9, 0, -9], "u": [0, 0, 18], "v": [18, 0, 0]}, "material": {"type": "diffuse", "reflectance": 0.5}},
            {**lamp, "emission": {"radiance": 393}},
            {"sphere": {"center": [0, 9, 0], "radius": 1.2}, "material": {"type": "dielectric", "index": 1.0001}},
        ],
    }
    with pytest.warns(UserWarning, match="of their light to one sample"):
        picture = tyndall.render(scene, spp=16, progress=False)
    assert picture.unseen_light > 0.1 > picture.median_error and len(picture.warnings) == 1
    assert picture.accumulation.error_against(0.1) == pytest.approx(picture.unseen_light, rel=0.3)
    del scene["shape"]
    scene["volume"] = [{"sphere": lamp["sphere"], "mu_t": 0.001, "albedo": 0, "emission_per_length": 1e13}]
    scene["camera"] = {"position": [0, 6, 0], "target": [0, 9, 0], "up": [0, 0, 1]}
    with pytest.warns(UserWarning, match="are left out"):
        picture = tyndall.render(scene, spp=2, progress=False)
    assert picture.rejected > 0 and np.isfinite(picture.image).all()


def test_pictures_are_written_by_their_extension(ball: Ball) -> None:
    picture = tyndall.render(ball, spp=2, progress=False)
    for name in ["a.exr", "a.png", "a.json", "a.acc"]:
        picture.save(name)
        assert pathlib.Path(name).stat().st_size > 0
    assert pathlib.Path("a.png").read_bytes() == picture._repr_png_()
    with pytest.raises(tyndall.Error, match="a.jpg: the name must end in .exr, .png, .acc or .json"):
        picture.save("a.jpg")
    with pytest.raises(tyndall.Error, match="its folder does not exist"):
        picture.save("none/a.png")


def test_pictures_of_bands_have_as_many_channels(ball: Ball) -> None:
    ball["render"] = {"mode": "spectral"}
    ball["film"].update(bands=[450, 550, 650, 700])
    picture = tyndall.render(ball, spp=1, progress=False)
    assert picture.channels == ["450nm", "550nm", "650nm", "700nm"]
    assert picture.image.shape == (14, 20, 4) and picture._repr_png_() is None
    with pytest.raises(tyndall.Error, match="at most three bands"):
        print(picture.accumulation)


def test_progress_is_told_to_a_function(endless: Ball) -> None:
    seen: list[tyndall.Progress] = []
    tyndall.render(endless, time=1.2, progress=seen.append)
    assert len(seen) >= 2 and seen[-1].samples >= seen[0].samples and seen[-1].seconds > 0.5
    images = [progress.image for progress in seen if progress.image is not None]
    assert images and images[0].shape == (256, 256, 3)


def test_what_progress_raises_ends_the_render(endless: Ball) -> None:
    def stop(progress: tyndall.Progress) -> None:
        raise LookupError("enough")

    start = time.monotonic()
    with pytest.raises(LookupError, match="enough"):
        tyndall.render(endless, progress=stop)
    assert time.monotonic() - start < 30


def test_other_threads_go_on_meanwhile(endless: Ball) -> None:
    scene = tyndall.Scene(endless)
    thread = threading.Thread(target=tyndall.render, args=(scene,), kwargs={"time": 1.0, "progress": False})
    thread.start()
    turns = 0
    while thread.is_alive():
        turns += 1
        time.sleep(0.001)
    assert turns > 20


def test_ctrl_c_returns_what_there_is_with_a_warning(endless: Ball) -> None:
    program = f"""
        import os, signal, threading, time, warnings, tyndall
        scene = {endless!r}
        pressed = []
        def press():
            pressed.append(time.monotonic())
            os.kill(os.getpid(), signal.SIGINT)
        def look(progress):
            # Not before every pixel has a sample.
            if progress.image is not None and not pressed:
                press()
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            picture = tyndall.render(scene, progress=look)
        print(not picture.complete, 0 < picture.samples < 100_000, "interrupted after" in str(caught[0].message))
        print(time.monotonic() - pressed[0])
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(program)], check=True, capture_output=True, text=True, timeout=120
    )
    told, seconds = done.stdout.splitlines()
    assert told == "True True True"
    assert float(seconds) < 10


def test_the_median_error_is_that_of_the_pixels(ball: Ball) -> None:
    picture = tyndall.render(ball, spp=16, progress=False)
    luminance = np.array([0.2126, 0.7152, 0.0722])
    relative = (picture.standard_error @ luminance) / (picture.image @ luminance)
    met = np.sort(relative[picture.layers["A"] > 0])
    assert picture.median_error == pytest.approx(met[len(met) // 2], rel=1e-5)
    np.testing.assert_array_equal(picture.standard_error, picture.accumulation.standard_error)


def test_ctrl_c_ends_the_building_of_a_scene() -> None:
    program = """
        import os, signal, threading, time, tyndall
        scene = tyndall.load(set={"volume.0.procedural.resolution": 700})
        pressed = []
        def press():
            time.sleep(0.3)
            pressed.append(time.monotonic())
            os.kill(os.getpid(), signal.SIGINT)
        threading.Thread(target=press).start()
        try:
            tyndall.render(scene, spp=1, progress=False)
        except KeyboardInterrupt:
            print(time.monotonic() - pressed[0], flush=True)
            os._exit(0)
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(program)], check=True, capture_output=True, text=True, timeout=120)
    assert float(done.stdout) < 10


def test_the_bar_is_shown_on_standard_error_only(ball: Ball, capsys: pytest.CaptureFixture[str]) -> None:
    scene = tyndall.Scene.of_volume(tyndall.Volume(np.ones((8, 8, 8))))
    scene["film.resolution"] = [64, 48]
    tyndall.render(scene, time=0.5)
    shown = capsys.readouterr()
    assert shown.out == "" and "note: light, camera and density are chosen" in shown.err
    tyndall.render(ball, spp=1, progress=False)
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"spp": 0}, "spp: give a whole number from 1 to 4294967295, not 0"),
        ({"seed": -1}, "seed: give a whole number from 0 to 4294967295, not -1"),
        ({"samples": (-3, 3)}, r"samples: \(-3, 3\) is no range"),
        ({"samples": (3, 3)}, r"samples: \(3, 3\) is no range"),
        ({"samples": (0, 3), "spp": 4}, "samples: says how many there are"),
        ({"error": -1.0}, "error: give a share above 0"),
        ({"error": "much"}, "error: write a share above 0"),
        ({"time": 0.0}, "time: give seconds above 0"),
        ({"threads": 0}, "threads: give a whole number from 1 to 65535, not 0"),
    ],
)
def test_options_that_make_no_sense_are_refused(ball: Ball, options: dict[str, Any], message: str) -> None:
    with pytest.raises(tyndall.Error, match=message):
        tyndall.render(ball, progress=False, **options)
