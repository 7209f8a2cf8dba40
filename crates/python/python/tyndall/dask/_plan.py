"""Which samples to render: rounds towards an error, and blocks of them.

Blocks may be cut in any way, as sums are exact: the picture does not depend on it. Rounds decide how many samples it has in the end,
and so depend on nothing but the scene.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

FIRST_ROUND = 16
"""Samples that an error is believed of: with fewer, pixels whose samples happen to agree pass for converged."""
FASTEST_GROWTH = 4
SLOWEST_GROWTH = 17 / 16

Samples = tuple[int, int]


@dataclass(frozen=True)
class Goal:
    """When a picture is done: after `spp` samples of each pixel, or once its median relative error is `error` or less."""

    spp: int | None
    error: float | None

    def first_round(self) -> int:
        """Samples of the first round.

        >>> Goal(64, None).first_round(), Goal(None, 0.01).first_round()
        (64, 16)
        """
        if self.error is None:
            assert self.spp is not None
            return self.spp
        return self._limited(FIRST_ROUND)

    def next_round(self, samples: int, error: float | None) -> int | None:
        """Samples in all after one more round, if after so many the error is this; `None` if that will do.

        The error falls with the root of the samples. Few samples know it badly, so that the next round is at most three times as
        large as all before; and at least a sixteenth, so that there are not too many.

        >>> goal = Goal(None, 0.01)
        >>> goal.next_round(16, 0.1), goal.next_round(64, 0.015), goal.next_round(64, 0.0101), goal.next_round(64, 0.009)
        (64, 144, 68, None)
        """
        if self.error is None or samples == self.spp or (error is not None and error <= self.error):
            return None
        growth = FASTEST_GROWTH if error is None or not math.isfinite(error) else (error / self.error) ** 2
        return self._limited(math.ceil(samples * min(max(growth, SLOWEST_GROWTH), FASTEST_GROWTH)))

    def _limited(self, samples: int) -> int:
        return samples if self.spp is None else min(samples, self.spp)


LONGEST_BLOCK = 30.0
"""Seconds: a lost worker costs as much, and Ctrl-C or a new worker come between blocks."""
SHORTEST_BLOCK = 2.0
"""Seconds: sending and adding up a block should take little beside it."""


class Pace:
    """Seconds that one worker takes for a sample of each pixel, learned as blocks come in; and blocks that suit it."""

    def __init__(self, block: int | None) -> None:
        self._block = block
        self._seconds: float | None = None

    @property
    def is_known(self) -> bool:
        """Whether blocks can be cut that suit the workers."""
        return self._block is not None or self._seconds is not None

    def learn(self, samples: int, seconds: float) -> None:
        """Takes note of a block. Those that had to wait for the scene tell too much, so that a faster one counts in full."""
        new = max(seconds, 1e-4) / samples
        self._seconds = new if self._seconds is None or new < self._seconds else (self._seconds + new) / 2

    def block(self, left: int, slots: int) -> int:
        """Samples of the next block, if so many are left to be handed out to so many slots.

        Towards the end blocks get smaller, so that all workers end together (guided self-scheduling, Polychronopoulos and Kuck 1987).

        >>> pace = Pace(None)
        >>> pace.block(640, 4)
        1
        >>> pace.learn(1, 0.1)
        >>> pace.block(640, 4), pace.block(64, 4), pace.block(4, 4)
        (160, 20, 20)
        """
        if self._block is not None:
            return self._block
        if self._seconds is None:
            return 1
        shortest, longest = SHORTEST_BLOCK / self._seconds, LONGEST_BLOCK / self._seconds
        return max(1, int(min(max(left / slots, shortest), longest)))
