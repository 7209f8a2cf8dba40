"""What workers do: render blocks of samples, one at a time with all of their threads, and add sums up."""

from __future__ import annotations

import os
import threading
from collections import OrderedDict
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from dask.sizeof import sizeof
from distributed import Status, Worker, get_worker

from tyndall import _files, _tyndall
from tyndall._errors import Error
from tyndall._tyndall import Accumulation, Progress, Scene, Volume

SCENES_KEPT = 2
"""Scenes that a worker keeps ready: that of the frame under way, and that of the next."""


@dataclass(frozen=True)
class Outline:
    """A scene without its contents: its text, and the names in it of the files and then of the volumes that stand beside."""

    key: str
    text: str
    files: tuple[str, ...]
    volumes: tuple[str, ...]


class Stopped(Exception):
    """Nobody wants the block any longer."""


class AddedAlready(Exception):
    """Sums are asked for again after others were added to what they were made of."""


def render_block(
    outline: Outline, contents: Sequence[bytes], samples: tuple[int, int], seed: int | None, threads: int | None
) -> Accumulation | None:
    """The sums of these samples of each pixel; nothing once they are not wanted any more."""
    worker = get_worker()
    bench = _bench(worker)
    key = worker.get_current_task()

    def look(_: Progress | None = None) -> None:
        task = worker.state.tasks.get(key)
        if task is None or task.state == "cancelled":
            raise Stopped

    try:
        # A block has all threads. The next one waits here already, so that no time passes between them.
        while not bench.turn.acquire(timeout=0.2):
            look()
        try:
            look()
            with _unprofiled(worker):
                picture = _tyndall.render(
                    bench.scene(outline, contents),
                    spp=None,
                    samples=samples,
                    error=None,
                    time=None,
                    seed=seed,
                    threads=threads or worker.state.nthreads,
                    report=look,
                    with_image=False,
                    with_error=False,
                    in_one_pass=True,
                )
        finally:
            bench.turn.release()
    except Stopped:
        return None
    except Error as error:
        # Files are somewhere else here; who sent them knows their names.
        raise type(error)(str(error).replace(f"{_files.folder()}{os.sep}", "")) from None
    return picture.accumulation


@contextmanager
def _unprofiled(worker: Worker) -> Iterator[None]:
    """Dask looks at what its threads do a hundred times a second. While a block is rendered it would see nothing but this call, and
    take two per cent of the time of two cores for that.
    """
    profiling = worker.periodic_callbacks.get("profile")
    if profiling is None:
        yield
        return

    def go_on() -> None:
        # One that has closed has stopped everything for good.
        if worker.status == Status.running:
            profiling.start()

    worker.loop.add_callback(profiling.stop)
    try:
        yield
    finally:
        worker.loop.add_callback(go_on)


def add(first: Accumulation, *others: Accumulation) -> Accumulation:
    """The sums of all their samples, added to the first, which nobody looks at any more.

    Should Dask want it a second time all the same, after a loss, that is refused, as it holds the samples already; then they are
    rendered again.
    """
    try:
        for other in others:
            first.merge(other)
    except Error as error:
        # Not the user's, and so no `Error`.
        raise AddedAlready(str(error)) from None
    return first


@dataclass
class Bench:
    """What a worker has at hand."""

    turn: threading.Lock = field(default_factory=threading.Lock)
    scenes: OrderedDict[str, Scene] = field(default_factory=OrderedDict)
    built: int = 0
    """Scenes made so far."""

    def scene(self, outline: Outline, contents: Sequence[bytes]) -> Scene:
        """The scene, made when it is first needed. Only the one whose turn it is may ask."""
        scene = self.scenes.get(outline.key)
        if scene is None:
            files = dict(zip(outline.files, contents, strict=False))
            grids = contents[len(files) :]
            volumes = {name: Volume.from_bytes(grid) for name, grid in zip(outline.volumes, grids, strict=True)}
            scene = self.scenes[outline.key] = _files.scene(outline.text, files, volumes)
            self.built += 1
            while len(self.scenes) > SCENES_KEPT:
                self.scenes.popitem(last=False)
        self.scenes.move_to_end(outline.key)
        return scene


def scenes_built(dask_worker: Worker) -> int:
    """How many scenes a worker has made so far, for `Client.run`."""
    return _bench(dask_worker).built


# Several workers may live in one process.
_benches: dict[str, Bench] = {}


def _bench(worker: Worker) -> Bench:
    return _benches.setdefault(worker.id, Bench())


# By its memory Dask decides where to add up, and what to keep.
_sizes: Any = sizeof
_sizes.register(Accumulation, lambda sums: sums.nbytes)
