"""One picture in the making: what is to be rendered, what is under way, and the sums so far, on workers and at home."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from tyndall._tyndall import Accumulation, Scene
from tyndall.dask._plan import Goal, Samples
from tyndall.dask._sending import SentScene
from tyndall.dask._types import Client, Future
from tyndall.dask._work import add


@dataclass(eq=False)
class Block:
    """Samples that are, or have been, rendered by one task."""

    samples: Samples
    attempt: int
    future: Future
    submitted: float


@dataclass(eq=False)
class Sums:
    """Sums on a worker, of some blocks."""

    future: Future
    blocks: list[Block]


@dataclass(eq=False)
class Picture:
    """One picture in the making."""

    frame: int
    scene: Scene
    goal: Goal
    seed: int | None
    sent: SentScene | None = None
    round_end: int = 0
    todo: list[tuple[Samples, int]] = field(default_factory=list)
    """Samples to be handed out, and how often that was tried before."""
    running: list[Block] = field(default_factory=list)
    partial: dict[str, Sums] = field(default_factory=dict)
    """Of each worker, the sums of what it has rendered since the picture was last brought home."""
    coming_home: Sums | None = None
    home: Accumulation | None = None

    def __post_init__(self) -> None:
        self.round_end = self.goal.first_round()
        self.todo.append(((0, self.round_end), 0))

    @property
    def left(self) -> int:
        """Samples that are still to be handed out."""
        return sum(end - first for (first, end), _ in self.todo)

    @property
    def samples(self) -> int:
        """Samples that are rendered."""
        return self.round_end - self.left - _count(self.running)

    @property
    def is_round_over(self) -> bool:
        """Whether all of this round is at home."""
        return not (self.todo or self.running or self.partial or self.coming_home)

    def take(self, samples: int) -> tuple[Samples, int]:
        """Some of what is to be handed out, at most so many."""
        (first, end), attempt = self.todo.pop(0)
        cut = min(end, first + samples)
        if cut < end:
            self.todo.insert(0, ((cut, end), attempt))
        return (first, cut), attempt

    def give_back(self, blocks: Iterable[Block]) -> int:
        """Blocks that are lost are to be rendered again; how often one of them was tried."""
        attempt = 0
        for block in blocks:
            self.todo.insert(0, (block.samples, block.attempt + 1))
            attempt = max(attempt, block.attempt + 1)
        return attempt

    def next_round(self) -> bool:
        """Plans the next round, of a picture that is at home; whether there is one."""
        assert self.home is not None
        asked = self.goal.error
        end = self.goal.next_round(self.round_end, None if asked is None else self.home.error_against(asked))
        if end is not None:
            self.todo.append(((self.round_end, end), 0))
            self.round_end = end
        return end is not None

    def gather(self, client: Client, blocks: Sequence[Block]) -> None:
        """Adds finished blocks to the sums of the workers that have them, where no data has to move."""
        holders = client.who_has([block.future for block in blocks])
        of_worker: dict[str, list[Block]] = {}
        for block in blocks:
            worker = next(iter(holders.get(block.future.key) or ()), "")
            of_worker.setdefault(worker, []).append(block)
        for worker, rendered in of_worker.items():
            futures = [block.future for block in rendered]
            before = self.partial.get(worker)
            if before is not None:
                futures.insert(0, before.future)
                rendered = before.blocks + rendered
            self.partial[worker] = Sums(_add(client, futures, worker), rendered)

    def bring_home(self, client: Client) -> None:
        """Adds up what the workers have: a tree of sums, two by two, all on the cluster."""
        sums = list(self.partial.values())
        futures = [part.future for part in sums]
        while len(futures) > 1:
            futures = [_add(client, futures[i : i + 2]) for i in range(0, len(futures), 2)]
        self.coming_home = Sums(futures[0], [block for part in sums for block in part.blocks])
        self.partial = {}

    def blocks_added(self) -> list[Block]:
        """The blocks that are in sums on workers."""
        sums = [*self.partial.values(), *([self.coming_home] if self.coming_home is not None else [])]
        return [block for part in sums for block in part.blocks]

    def take_in(self, sums: Accumulation) -> None:
        """Sums that have come home. Those that were there before do not change: somebody may look at them."""
        self.home = sums if self.home is None else self.home + sums
        self.coming_home = None


def _add(client: Client, futures: Sequence[Future], worker: str = "") -> Future:
    if len(futures) == 1:
        return futures[0]
    # Before blocks, as sums free memory. The worker is a wish: it may be lost.
    where = {"workers": [worker], "allow_other_workers": True} if worker else {}
    return client.submit(add, *futures, pure=False, priority=10, **where)


def _count(blocks: Iterable[Block]) -> int:
    return sum(end - first for first, end in (block.samples for block in blocks))
