"""Pictures on a cluster: hands out blocks, two for each worker, and sees to what becomes of them.

What is lost with a worker Dask makes again from what it was made of; what Dask gives up is handed out anew from here.
"""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from tyndall._errors import Error
from tyndall._tyndall import Accumulation
from tyndall.dask._picture import Block, Picture
from tyndall.dask._plan import Pace
from tyndall.dask._sending import Sending
from tyndall.dask._types import Client, Future
from tyndall.dask._work import render_block

SLOTS_PER_WORKER = 2
"""One block is rendered, and one waits, so that no worker is idle while it is heard of."""
GLANCE = 0.05
"""Seconds between two looks at what has become of blocks."""
ROLL_CALL = 2.0
"""Seconds between two looks at which workers there are."""
HOMECOMING_SHARE = 0.05
"""Bringing pictures home takes no more than this share of the time."""
LAST_HOMECOMING = 60.0
"""Seconds that an interrupted picture may take to come home."""


@dataclass
class Pool:
    """Renders pictures, the blocks of the first before those of the next."""

    client: Client
    open_next: Callable[[], Picture | None]
    """The next picture, if there is one more."""
    is_shared: bool
    """Whether all workers take part in each picture, and so get its scene."""
    retries: int
    threads: int | None
    pace: Pace
    refresh: float
    """Seconds between two times that a picture is brought home at least."""
    report: Callable[[Picture, int, bool], object]
    """Told every now and then of a picture, the number of workers, and whether its sums at home are new."""
    pictures: list[Picture] = field(default_factory=list)
    _next: Picture | None = None
    _workers: int = 1
    _roll_called: float = 0.0
    _last_heard: dict[str, float] = field(default_factory=dict)
    _next_homecoming: float = 0.0

    def __post_init__(self) -> None:
        self._sending = Sending(self.client)
        self._next_homecoming = time.monotonic() + self.refresh

    def run(self) -> Iterator[Picture]:
        """Renders, and yields pictures as they are done."""
        self._next = self.open_next()
        while self._next is not None or self.pictures:
            self._call_roll()
            self._hand_out()
            for picture in list(self.pictures):
                self._collect(picture)
                if self._come_home(picture) and picture.is_round_over and not picture.next_round():
                    self.pictures.remove(picture)
                    yield picture
                elif not picture.is_round_over:
                    self.report(picture, self._workers, False)
            time.sleep(GLANCE)

    def stop(self) -> None:
        """Cancels what is under way."""
        running = [block.future for picture in self.pictures for block in picture.running]
        futures = [future for future in running if future.status == "pending"]
        if futures:
            self.client.cancel(futures)

    def rescue(self, picture: Picture) -> Accumulation | None:
        """What there is of a picture after `stop`, brought home in good time."""
        # If it fails, what had come home before has to do.
        with contextlib.suppress(Exception, KeyboardInterrupt):
            # Ctrl-C may have come when a block was added already, and still counted as running.
            added = picture.blocks_added()
            done = [block for block in picture.running if block.future.status == "finished" and block not in added]
            if done:
                picture.gather(self.client, done)
            while picture.coming_home is not None or picture.partial:
                if picture.coming_home is None:
                    picture.bring_home(self.client)
                else:
                    picture.take_in(picture.coming_home.future.result(timeout=LAST_HOMECOMING))
        return picture.home

    def _call_roll(self) -> None:
        if time.monotonic() - self._roll_called > ROLL_CALL:
            self._workers = max(1, len(self.client.nthreads()))
            self._roll_called = time.monotonic()

    def _hand_out(self) -> None:
        # The first block tells how long the next may be.
        slots = (SLOTS_PER_WORKER if self.pace.is_known else 1) * self._workers
        # A worker alone has nobody to end together with.
        alone = self._workers == 1
        free = slots - sum(len(picture.running) for picture in self.pictures)
        while free > 0:
            picture = next((picture for picture in self.pictures if picture.todo), None)
            if picture is None:
                # A picture that comes home takes memory as well, so that not too many are begun.
                if self._next is None or len(self.pictures) >= slots + 2:
                    return
                picture, self._next = self._next, self.open_next()
                self.pictures.append(picture)
            # If others follow, there is no end to be met together.
            sharers = slots if self._next is None and not alone else 1
            samples, attempt = picture.take(self.pace.block(picture.left, sharers))
            if picture.sent is None:
                picture.sent = self._sending.send(picture.scene, to_all=self.is_shared)
            future = self.client.submit(
                render_block,
                picture.sent.outline,
                list(picture.sent.contents),
                samples,
                picture.seed,
                self.threads,
                pure=False,
                # First come, first served, even if what comes first is done again.
                priority=-picture.frame,
            )
            picture.running.append(Block(samples, attempt, future, time.monotonic()))
            free -= 1

    def _collect(self, picture: Picture) -> None:
        done = [block for block in picture.running if block.future.status == "finished"]
        failed = [block for block in picture.running if block.future.status in ("error", "cancelled")]
        if not done and not failed:
            return
        if done:
            picture.gather(self.client, done)
            self._learn(done, picture)
        picture.running = [block for block in picture.running if block not in done and block not in failed]
        for block in failed:
            self._try_again(picture, block.future, [block])

    def _learn(self, done: list[Block], picture: Picture) -> None:
        now = time.monotonic()
        for worker, sums in picture.partial.items():
            fresh = [block for block in sums.blocks if block in done]
            if fresh:
                began = max(min(block.submitted for block in fresh), self._last_heard.get(worker, 0.0))
                self.pace.learn(sum(end - first for first, end in (block.samples for block in fresh)), now - began)
                self._last_heard[worker] = now

    def _come_home(self, picture: Picture) -> bool:
        """Whether the picture has just come home."""
        for worker, sums in list(picture.partial.items()):
            if sums.future.status in ("error", "cancelled"):
                del picture.partial[worker]
                self._try_again(picture, sums.future, sums.blocks)
        now = time.monotonic()
        sums_coming = picture.coming_home
        if sums_coming is None:
            is_due = now >= self._next_homecoming or not (picture.todo or picture.running)
            if picture.partial and is_due:
                picture.bring_home(self.client)
            return False
        if sums_coming.future.status in ("error", "cancelled"):
            picture.coming_home = None
            self._try_again(picture, sums_coming.future, sums_coming.blocks)
            return False
        if sums_coming.future.status != "finished":
            return False
        began = time.monotonic()
        picture.take_in(sums_coming.future.result())
        self.report(picture, self._workers, True)
        now = time.monotonic()
        self._next_homecoming = now + max(self.refresh, (now - began) / HOMECOMING_SHARE)
        return True

    def _try_again(self, picture: Picture, future: Future, blocks: list[Block]) -> None:
        """Blocks whose task failed are to be rendered again, unless that is no use."""
        reason = future.exception()
        if isinstance(reason, Error):
            raise type(reason)(picture.sent.here(str(reason)) if picture.sent else str(reason)) from None
        if isinstance(reason, ModuleNotFoundError):
            raise Error(f"a worker lacks a module ({reason}); install tyndall in the environment of the workers") from reason
        attempt = picture.give_back(blocks)
        # The scene may have been lost with the last worker that had it.
        if future.status == "cancelled":
            picture.sent = None
        if attempt > self.retries:
            first, end = blocks[0].samples
            raise Error(f"samples {first}..{end} failed {attempt} times, at last so: {_line(reason)}") from reason


def _line(reason: BaseException | None) -> str:
    text = " ".join(str(reason).split())
    return f"{type(reason).__name__}: {text}" if text else type(reason).__name__
