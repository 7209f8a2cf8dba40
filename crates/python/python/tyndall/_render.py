"""`tyndall.load` and `tyndall.render`."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Mapping
from typing import Any

from tyndall import _tyndall
from tyndall._errors import Error
from tyndall._progress import Bar, say
from tyndall._tyndall import Progress, Render, Scene, Volume


def load(
    path: str | os.PathLike[str] | None = None,
    *,
    set: Mapping[str, Any] | None = None,
    frame: int | None = None,
    define: Mapping[str, str] | None = None,
    strict: bool = False,
) -> Scene:
    """Opens whatever the command `tyndall render` does.

    That is a scene file (`.toml`), a scene of pbrt-v4 (`.pbrt`) or Mitsuba 3 (`.xml`), or a volume file, for which camera, light
    and density are chosen from the data; without a path it is the built-in cumulus. `set` changes values by their path, `frame` opens an animation, in
    whose names of files `####` is the number of the frame, at this one: `scene.at_frame(n)` is then the scene of each. `define` says what `$NAME` stands for in a scene of
    Mitsuba, and `strict` refuses scenes of other renderers of which something is not supported. What was guessed is in the
    scene's `notes`.

    >>> import tempfile, pathlib, tyndall
    >>> path = pathlib.Path(tempfile.mkdtemp()) / "ball.toml"
    >>> _ = path.write_text('''
    ... camera = { position = [0, 0, 5], target = [0, 0, 0] }
    ... volume = [{ sphere = { center = [0, 0, 0], radius = 1 }, mu_t = 1, albedo = 1 }]
    ... light = [{ type = "constant", radiance = 1 }]
    ... ''')
    >>> tyndall.load(path, set={"film.resolution": [8, 6]})
    <tyndall.Scene 8x6, 1 volume, 1 light>
    """
    scene = Scene.load(path, frame=frame, define=dict(define or {}), strict=strict)
    for key, value in (set or {}).items():
        scene[key] = value
    return scene


def as_scene(scene: Scene | Volume | Mapping[str, Any] | str | os.PathLike[str]) -> Scene:
    """Whatever stands for a scene, as one."""
    if isinstance(scene, Scene):
        return scene
    if isinstance(scene, Volume):
        return Scene.of_volume(scene)
    if isinstance(scene, (str, os.PathLike)):
        return load(scene)
    return Scene(scene)


def render(
    scene: Scene | Volume | Mapping[str, Any] | str | os.PathLike[str],
    spp: int | None = None,
    seed: int | None = None,
    *,
    samples: tuple[int, int] | None = None,
    error: float | str | None = None,
    time: float | None = None,
    threads: int | None = None,
    progress: bool | Callable[[Progress], object] = True,
) -> Render:
    """Renders a scene, with the same bits as the command for the same scene and seed.

    `scene` is a `Scene`, or what one is made of: a dictionary, a file's name, or a `Volume`, for which a scene is made up.

    The render ends after `spp` samples of each pixel (those the scene asks for, 64 unless it does), or when the median relative
    standard error of the pixels is below `error` (such as `0.01` or `"1%"`) and no more light than that is known to be unseen by
    most of them (`Render.unseen_light`), or after `time` seconds, whichever of those given
    comes first; `samples=(a, b)` makes only these samples, to be merged with others. `threads` are as many as there are cores;
    the picture does not depend on them.

    `progress` shows a bar, of tqdm if there is one; a function is called with a `Progress` every now and then, from the thread
    that called. Other threads of Python go on meanwhile. Ctrl-C stops at once and returns what there is, with a warning.

    >>> import tyndall
    >>> fog = {"camera": {"position": [0, 0, 0], "direction": [0, 0, 1]}, "film": {"resolution": [4, 3]},
    ...        "medium": {"mu_a": 0.5, "mu_s": 0}, "light": {"type": "constant", "radiance": 1},
    ...        "shape": {"rectangle": {"corner": [-9, -9, 2], "u": [18, 0, 0], "v": [0, 18, 0]}, "material": {"type": "diffuse",
    ...        "reflectance": 0}, "emission": {"radiance": 1}}}
    >>> picture = tyndall.render(fog, spp=4, progress=False)
    >>> picture.samples, picture.complete
    (4.0, True)
    """
    scene = as_scene(scene)
    for note in scene.notes if progress is True else []:
        say(f"note: {note}")
    bar = Bar() if progress is True else None
    report = bar if bar is not None else progress if callable(progress) else None
    try:
        picture = _tyndall.render(
            scene,
            spp=spp,
            samples=samples,
            error=_share(error),
            time=time,
            seed=seed,
            threads=threads,
            report=report,
            with_image=callable(progress),
        )
    finally:
        if bar is not None:
            bar.close()
    if progress is True:
        for note in picture.notes[len(scene.notes) :]:
            say(f"note: {note}")
    for warning in picture.warnings:
        warnings.warn(warning, stacklevel=2)
    if not picture.complete:
        warnings.warn(f"interrupted after {picture.samples:.4g} samples a pixel", stacklevel=2)
    return picture


def _share(error: float | str | None) -> float | None:
    """A share as a number: "1%" is 0.01."""
    if not isinstance(error, str):
        return error
    number, scale = (error.strip()[:-1], 0.01) if error.strip().endswith("%") else (error, 1.0)
    try:
        return float(number) * scale
    except ValueError:
        raise Error("error: write a share above 0, such as 0.01 or '1%'") from None
