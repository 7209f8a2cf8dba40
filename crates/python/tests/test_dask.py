"""Rendering on a cluster: the bits of one process, whatever becomes of the workers."""

from __future__ import annotations

import os
import pathlib
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
import tyndall

distributed = pytest.importorskip("distributed", reason="pip install dask distributed")

import tyndall.dask
from tyndall.dask import _pool, _sending, _work

Client = Any


@pytest.fixture(scope="module")
def two_workers() -> Iterator[Client]:
    """A cluster of two worker processes."""
    settings = {"distributed.admin.log-format": "%(message)s", "distributed.logging.distributed": "critical"}
    with (
        __import__("dask").config.set(settings),
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster,
        distributed.Client(cluster) as client,
    ):
        yield client


@pytest.fixture(scope="module")
def one_worker() -> Iterator[Client]:
    """A cluster of one worker, in this process."""
    with distributed.Client(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=":0") as client:
        yield client


@pytest.fixture
def cloud(blob: np.ndarray) -> tyndall.Scene:
    """A small cloud from an array."""
    volume = tyndall.Volume(blob, spacing=0.1, origin=[-0.5, -1, -0.8])
    return tyndall.Scene({
        "camera": {"position": [0, 0, 6], "target": [0, 0, 0], "vertical_fov": 20},
        "film": {"resolution": [24, 16]},
        "volume": {"file": volume, "mu_t": 30, "albedo": 0.99},
        "light": {"type": "constant", "radiance": 1},
    })


@pytest.fixture
def slow(cloud: tyndall.Scene) -> tyndall.Scene:
    """The same, so that 64 samples take seconds."""
    cloud["film.resolution"] = [144, 96]
    return cloud


def alone(scene: Any, **options: Any) -> tyndall.Accumulation:
    return tyndall.render(scene, progress=False, **options).accumulation


def test_two_workers_give_the_bits_of_one_process(two_workers: Client, cloud: tyndall.Scene) -> None:
    for options in [{"spp": 32}, {"spp": 7, "seed": 3}]:
        picture = tyndall.dask.render(two_workers, cloud, block=3, progress=False, **options)
        assert picture.accumulation == alone(cloud, **options), options
        assert picture.complete and picture.samples == options["spp"]
        np.testing.assert_array_equal(picture.image, tyndall.render(cloud, progress=False, **options).image)


def test_the_scene_is_sent_to_each_worker_once(two_workers: Client, cloud: tyndall.Scene) -> None:
    def scenes_received(dask_worker: Any) -> int:
        keys = [str(key) for transfer in dask_worker.transfer_incoming_log for key in transfer["keys"]]
        return sum(key.startswith("tyndall-scene") for key in keys)

    before = two_workers.run(scenes_received), two_workers.run(_work.scenes_built)
    cloud["volume.0.mu_t"] = 31
    tyndall.dask.render(two_workers, cloud, spp=24, block=1, progress=False)
    received, built = two_workers.run(scenes_received), two_workers.run(_work.scenes_built)
    assert [built[worker] - before[1][worker] for worker in built] == [1, 1]
    # The outline and the volume, which came from here to one of them, and from there to the other.
    assert sum(received.values()) - sum(before[0].values()) <= 2


def test_the_number_of_samples_at_an_error_does_not_depend_on_the_cluster(
    two_workers: Client, one_worker: Client, cloud: tyndall.Scene
) -> None:
    here = tyndall.dask.render(one_worker, cloud, error="0.4%", block=5, progress=False)
    there = tyndall.dask.render(two_workers, cloud, error=0.004, block=3, progress=False)
    assert here.median_error is not None and here.median_error <= 0.004 and here.samples > 16
    assert here.accumulation == there.accumulation == alone(cloud, spp=int(here.samples))
    assert tyndall.dask.render(one_worker, cloud, error=1e-9, spp=20, progress=False).samples == 20


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="processes are killed in another way here")
@pytest.mark.parametrize("count", [1, 2])
def test_killed_workers_cost_time_but_no_sample(two_workers: Client, slow: tyndall.Scene, count: int) -> None:
    killed: list[int] = []

    def kill(progress: tyndall.dask.Progress) -> None:
        if not killed and 8 <= progress.samples < 48:
            killed.extend(list(two_workers.run(os.getpid).values())[:count])
            for pid in killed:
                os.kill(pid, signal.SIGKILL)

    two_workers.wait_for_workers(2)
    picture = tyndall.dask.render(two_workers, slow, spp=64, block=2, progress=kill)
    assert len(killed) == count
    assert picture.accumulation == alone(slow, spp=64)


def test_a_wrong_scene_is_told_as_on_one_machine(two_workers: Client, cloud: tyndall.Scene) -> None:
    pathlib.Path("broken.vdb").write_bytes(b"no volume at all")
    scene = tyndall.Scene({**cloud.to_dict(), "volume": {"file": "broken.vdb", "mu_t": 1, "albedo": 1}})
    with pytest.raises(tyndall.Error) as here:
        tyndall.render(scene, spp=4, progress=False)
    with pytest.raises(tyndall.Error) as there:
        tyndall.dask.render(two_workers, scene, spp=4, progress=False)
    assert str(there.value) == str(here.value) and str(pathlib.Path("broken.vdb").resolve()) in str(here.value)
    pathlib.Path("broken.vdb").unlink()
    with pytest.raises(tyndall.Error, match="broken.vdb: No such file"):
        tyndall.dask.render(two_workers, scene, spp=4, progress=False)


def test_ctrl_c_cancels_and_returns_what_there_is(two_workers: Client, slow: tyndall.Scene) -> None:
    two_workers.wait_for_workers(2)

    def press(progress: tyndall.dask.Progress) -> None:
        if progress.samples >= 4:
            raise KeyboardInterrupt

    with pytest.warns(UserWarning, match="interrupted after"):
        picture = tyndall.dask.render(two_workers, slow, spp=100_000, block=2, progress=press)
    assert not picture.complete and 4 <= picture.samples < 100
    total = picture.accumulation
    for first, end in picture.accumulation.samples:
        assert first % 2 == end % 2 == 0
    missing = [(0, 64)] if not total.samples else _gaps(total.samples)
    for gap in missing:
        total.merge(alone(slow, samples=gap))
    assert total == alone(slow, spp=total.samples[0][1])


def _gaps(ranges: list[tuple[int, int]]) -> list[tuple[int, int]]:
    ends = [0, *(end for _, end in ranges)]
    return [(end, first) for end, (first, _) in zip(ends, ranges, strict=False) if end < first]


def test_a_block_that_nobody_wants_ends_at_once(two_workers: Client, slow: tyndall.Scene) -> None:
    start = time.monotonic()

    def press(progress: tyndall.dask.Progress) -> None:
        if progress.seconds > 0.5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        tyndall.dask.render(two_workers, slow, spp=1_000_000, block=100_000, progress=press)
    tyndall.dask.render(two_workers, slow, spp=2, progress=False)
    assert time.monotonic() - start < 60


def test_pictures_come_home_meanwhile(two_workers: Client, slow: tyndall.Scene) -> None:
    seen: list[tyndall.dask.Progress] = []
    tyndall.dask.render(two_workers, slow, spp=128, block=2, refresh=0.1, progress=seen.append, save=["live.acc", "live.png"])
    pictures = [progress for progress in seen if progress.image is not None]
    assert len(pictures) >= 2 and len(seen) >= len(pictures)
    assert pictures[0].image is not None and pictures[0].image.shape == (96, 144, 3)
    assert pictures[-1].samples == 128 and pictures[-1].workers == 2 and pictures[-1].error is not None
    assert tyndall.Accumulation.read("live.acc") == alone(slow, spp=128)
    assert pathlib.Path("live.png").exists()


def test_dasks_profiler_rests_while_a_block_is_rendered(two_workers: Client, slow: tyndall.Scene) -> None:
    def is_running(dask_worker: Any) -> bool:
        return bool(dask_worker.periodic_callbacks["profile"].is_running())

    def wait_for(both: bool) -> None:
        end = time.monotonic() + 10
        while set(two_workers.run(is_running).values()) != {both}:
            # Stopped and started on the worker's own loop, which need not have come to it.
            assert time.monotonic() < end
            time.sleep(0.05)

    def wait_and_end(_: tyndall.dask.Progress) -> None:
        wait_for(False)
        raise KeyboardInterrupt

    two_workers.wait_for_workers(2)
    # Blocks so long that they last on the fastest of machines until they are no longer wanted.
    with pytest.raises(KeyboardInterrupt):
        tyndall.dask.render(two_workers, slow, spp=1_000_000, block=100_000, progress=wait_and_end)
    wait_for(True)


def test_frames_have_the_bits_of_their_scenes(two_workers: Client, cloud: tyndall.Scene) -> None:
    def scene(frame: int) -> tyndall.Scene:
        moved = cloud.copy()
        moved["camera.position"] = [frame / 10, 0, 6]
        return moved

    pictures = dict(tyndall.dask.render_frames(two_workers, scene, range(3, 8), spp=4))
    assert sorted(pictures) == [3, 4, 5, 6, 7]
    for frame, picture in pictures.items():
        assert picture.accumulation == alone(scene(frame), spp=4), frame
    ((number, picture),) = tyndall.dask.render_frames(two_workers, {9: cloud}, error=0.05)
    assert number == 9 and picture.accumulation == alone(cloud, spp=int(picture.samples))
    with pytest.raises(tyndall.Error, match="there is no scene 1"):
        list(tyndall.dask.render_frames(two_workers, [cloud], [0, 1], spp=1))


class Unlucky:
    """Renders, but fails the first so many times."""

    def __init__(self, failures: int) -> None:
        self.left, self.lock = failures, threading.Lock()

    def render_block(self, *arguments: Any) -> Any:
        with self.lock:
            self.left -= 1
            if self.left >= 0:
                raise ConnectionError("out of luck")
        return _work.render_block(*arguments)


unlucky = Unlucky(0)


def try_luck(*arguments: Any) -> Any:
    return unlucky.render_block(*arguments)


@pytest.fixture
def luck(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Lets the next so many blocks fail, of workers in this process."""

    def have(failures: int) -> None:
        monkeypatch.setitem(sys.modules, __name__, sys.modules.get(__name__, sys.modules[Unlucky.__module__]))
        monkeypatch.setattr(sys.modules[Unlucky.__module__], "unlucky", Unlucky(failures))
        monkeypatch.setattr(_pool, "render_block", try_luck)

    return have


def test_blocks_that_fail_are_tried_again(one_worker: Client, cloud: tyndall.Scene, luck: Callable[[int], None]) -> None:
    luck(3)
    picture = tyndall.dask.render(one_worker, cloud, spp=6, block=2, retries=3, progress=False)
    assert picture.accumulation == alone(cloud, spp=6)
    luck(9)
    with pytest.raises(tyndall.Error, match=r"samples \d\.\.\d failed 2 times, at last so: ConnectionError: out of luck"):
        tyndall.dask.render(one_worker, cloud, spp=6, block=2, retries=1, progress=False)


def test_workers_of_another_version_are_refused(one_worker: Client, cloud: tyndall.Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_sending, "__version__", "9.9.9")
    with pytest.raises(tyndall.Error, match=r"has tyndall \d.*, and this is tyndall 9.9.9; install 9.9.9 in the environment"):
        tyndall.dask.render(one_worker, cloud, spp=1, progress=False)
    with pytest.raises(tyndall.Error, match="client: give a dask.distributed.Client"):
        tyndall.dask.render("tcp://scheduler:8786", cloud, spp=1, progress=False)  # type: ignore[arg-type]


def test_without_dask_one_line_says_what_to_install() -> None:
    program = "import sys, tyndall; sys.modules['distributed'] = None; tyndall.dask.render"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.stderr.splitlines()[-1] == "ImportError: tyndall.dask needs Dask: pip install dask distributed"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"spp": 0}, "spp: give a whole number from 1, not 0"),
        ({"block": 1.5}, "block: give a whole number from 1, not 1.5"),
        ({"error": "much"}, "error: write a share above 0"),
        ({"error": -1}, "error: give a share above 0"),
    ],
)
def test_options_that_make_no_sense_are_refused(
    one_worker: Client, cloud: tyndall.Scene, options: dict[str, Any], message: str
) -> None:
    with pytest.raises(tyndall.Error, match=message):
        tyndall.dask.render(one_worker, cloud, progress=False, **options)
