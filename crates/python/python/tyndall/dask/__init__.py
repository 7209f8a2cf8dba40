"""Pictures on many machines, by Dask: on the cores of this one, on Slurm, Kubernetes, or wherever else Dask runs.

    from distributed import Client
    import tyndall.dask

    client = Client()                       # or the Client of any other cluster
    picture = tyndall.dask.render(client, "cloud.toml", error=0.01)
    picture.save("cloud.exr")

The bits are those of `tyndall.render` on one machine: samples are drawn by their numbers, and their sums are exact in any order.
docs/dask.md tells how this scales.
"""

from __future__ import annotations

import os
import time
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

try:
    from distributed import Client
except ImportError as error:
    raise ImportError("tyndall.dask needs Dask: pip install dask distributed", name=error.name) from None

from tyndall._errors import Error
from tyndall._progress import Bar, say
from tyndall._render import _share, as_scene
from tyndall._tyndall import Accumulation, Render, Scene, Volume
from tyndall.dask._picture import Picture
from tyndall.dask._plan import Goal, Pace
from tyndall.dask._pool import Pool
from tyndall.dask._sending import check

__all__ = ["Progress", "render", "render_frames"]

AnyScene = Scene | Volume | Mapping[str, Any] | str | os.PathLike[str]

REFRESH = 10.0
"""Seconds between two pictures for whom somebody waits."""
SAFETY = 60.0
"""Seconds between two times that sums are brought home just so that they cannot be lost."""
REPORT = 0.2
"""Seconds between two reports."""


@dataclass(frozen=True)
class Progress:
    """What is known of a render under way."""

    samples: float
    """Samples of each pixel so far."""
    spp: int | None
    """Samples that will be made at most; `None` if only an error ends the render."""
    error: float | None
    """Median relative standard error of the picture as it was last brought home."""
    seconds: float
    """Time since the start."""
    workers: int
    """Workers that there are now."""
    accumulation: Accumulation | None
    """The sums so far, if there are new ones: to be looked at, and saved, but not changed."""

    @property
    def image(self) -> npt.NDArray[np.float32] | None:
        """The picture so far, of shape (H, W, 3), if there is a new one."""
        return None if self.accumulation is None else self.accumulation.image


def render(
    client: Client,
    scene: AnyScene,
    spp: int | None = None,
    seed: int | None = None,
    *,
    error: float | str | None = None,
    block: int | None = None,
    retries: int = 3,
    threads: int | None = None,
    refresh: float = REFRESH,
    progress: bool | Callable[[Progress], object] = True,
    save: str | os.PathLike[str] | Sequence[str | os.PathLike[str]] = (),
) -> Render:
    """Renders a scene on all workers of a cluster, with the same bits as `tyndall.render` for as many samples.

    The render ends after `spp` samples of each pixel (those the scene asks for), or when the median relative standard error of the
    pixels is at most `error`, whichever of those given comes first. The error is looked at after rounds that depend on nothing but
    the scene, and so the number of samples does not depend on the cluster either.

    A task renders `block` samples of each pixel, on as many `threads` as its worker has; unless given, so many that it takes two
    to thirty seconds. Workers may come and go: what is lost with one is rendered again. A task that fails is tried `retries` times more.

    `progress` shows a bar; a function is called with a `Progress` every now and then, and with the picture so far every `refresh`
    seconds at most. Then it is also written to the files of `save` (`.exr`, `.png`, `.acc`, `.json`). Ctrl-C cancels what is under
    way and returns what there is, with a warning.

    >>> import distributed, tyndall.dask
    >>> fog = {"camera": {"position": [0, 0, 0], "direction": [0, 0, 1]}, "film": {"resolution": [4, 3]},
    ...        "medium": {"mu_t": 0.5, "albedo": 0.9}, "light": {"type": "constant", "radiance": 1}}
    >>> with distributed.Client(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=":0") as client:
    ...     picture = tyndall.dask.render(client, fog, spp=4, progress=False)
    >>> picture.accumulation == tyndall.render(fog, spp=4, progress=False).accumulation
    True
    """
    scene = as_scene(scene)
    outputs = [save] if isinstance(save, (str, os.PathLike)) else list(save)
    goal = _goal(scene, spp, error)
    bar = Bar() if progress is True else None
    report: Callable[[Any], object] | None = bar if bar is not None else progress if callable(progress) else None
    watched = _Watched(report, float(scene["film.exposure"]), outputs)
    pictures = iter([Picture(0, scene, goal, seed)])
    pool = Pool(
        client=client,
        open_next=lambda: next(pictures, None),
        is_shared=True,
        retries=retries,
        threads=threads,
        pace=Pace(_at_least_one("block", block)),
        refresh=refresh if report is not None or outputs else max(refresh, SAFETY),
        report=watched,
    )
    for note in scene.notes if progress is True else []:
        say(f"note: {note}")
    is_complete = True
    sums: Accumulation | None = None
    try:
        check(client)
        for picture in pool.run():
            sums = picture.home
    except KeyboardInterrupt:
        is_complete = False
        pool.stop()
        for picture in pool.pictures:
            sums = pool.rescue(picture)
        if sums is None:
            raise
    except BaseException:
        pool.stop()
        raise
    finally:
        if bar is not None:
            bar.close()
    assert sums is not None
    if not is_complete:
        made = sum(end - first for first, end in sums.samples)
        warnings.warn(f"interrupted after {made} samples a pixel", stacklevel=2)
    result = Render.from_accumulation(sums, exposure=watched.exposure, notes=scene.notes, complete=is_complete)
    for path in outputs:
        result.save(path)
    for warning in result.warnings:
        warnings.warn(warning, stacklevel=2)
    return result


def render_frames(
    client: Client,
    scenes: Callable[[int], AnyScene] | Mapping[int, AnyScene] | Sequence[AnyScene],
    frames: Iterable[int] | None = None,
    spp: int | None = None,
    seed: int | None = None,
    *,
    error: float | str | None = None,
    block: int | None = None,
    retries: int = 3,
    threads: int | None = None,
) -> Iterator[tuple[int, Render]]:
    """Renders the frames of an animation on a cluster, and yields each with its number when it is done.

    `scenes` is a function from the number of a frame to its scene, or a list or dictionary of scenes; `frames` are the numbers to
    render, in this order, by default all of the list or dictionary. The other arguments are those of `render`, of which each frame
    has the bits. Workers go on with the next frame while others end the last one, and the next scene is on its way meanwhile;
    a content that frames share, such as a volume, goes to a worker once. Frames that take longer may come after later ones.

        for frame, picture in tyndall.dask.render_frames(client, lambda frame: f"cloud.{frame:04}.vdb", range(1, 241), spp=64):
            picture.save(f"cloud.{frame:04}.exr")

    An end of the loop cancels what is under way.
    """
    if frames is None:
        if callable(scenes):
            raise Error("frames: say which, as `scenes` is a function")
        frames = list(scenes) if isinstance(scenes, Mapping) else range(len(scenes))
    numbers = iter(enumerate(frames))
    names: dict[int, int] = {}

    def open_next() -> Picture | None:
        place, number = next(numbers, (None, 0))
        if place is None:
            return None
        try:
            scene = as_scene(scenes(number) if callable(scenes) else scenes[number])
        except LookupError:
            raise Error(f"frames: there is no scene {number}") from None
        names[place] = number
        return Picture(place, scene, _goal(scene, spp, error), seed)

    pool = Pool(
        client=client,
        open_next=open_next,
        is_shared=False,
        retries=retries,
        threads=threads,
        pace=Pace(_at_least_one("block", block)),
        refresh=SAFETY,
        report=lambda picture, workers, is_new: None,
    )
    check(client)
    try:
        for picture in pool.run():
            scene = picture.scene
            assert picture.home is not None
            exposure = float(scene["film.exposure"])
            yield names.pop(picture.frame), Render.from_accumulation(picture.home, exposure=exposure, notes=scene.notes)
    finally:
        pool.stop()


class _Watched:
    """Tells the user of a picture in the making, and writes it."""

    def __init__(
        self, report: Callable[[Any], object] | None, exposure: float, outputs: Sequence[str | os.PathLike[str]]
    ) -> None:
        self.exposure = exposure
        self._report = report
        self._outputs = outputs
        self._start = time.monotonic()
        self._last = self._start
        self._error: float | None = None

    def __call__(self, picture: Picture, workers: int, is_new: bool) -> None:
        now = time.monotonic()
        if is_new and picture.home is not None:
            for path in self._outputs:
                picture.home.save(path, exposure=self.exposure)
        if self._report is None or (not is_new and now - self._last < REPORT):
            return
        self._last = now
        if is_new and picture.home is not None:
            error = picture.home.median_error
            self._error = error if error is not None and np.isfinite(error) else None
        self._report(
            Progress(
                samples=picture.samples,
                spp=picture.goal.spp,
                error=self._error,
                seconds=now - self._start,
                workers=workers,
                accumulation=picture.home if is_new else None,
            )
        )


def _goal(scene: Scene, spp: int | None, error: float | str | None) -> Goal:
    share = _share(error)
    if share is not None and not (np.isfinite(share) and share > 0):
        raise Error("error: give a share above 0, such as 0.01")
    spp = _at_least_one("spp", spp)
    if spp is None and share is None:
        spp = int(scene["render.spp"])
    return Goal(spp, share)


def _at_least_one(name: str, number: int | None) -> int | None:
    if number is not None and (not isinstance(number, (int, np.integer)) or number < 1):
        raise Error(f"{name}: give a whole number from 1, not {number}")
    return None if number is None else int(number)
