"""Progress for people: a bar of tqdm, or a line on the terminal."""

from __future__ import annotations

import sys
from typing import Any

from tyndall._tyndall import Progress


def say(line: str) -> None:
    """One line for people."""
    print(line, file=sys.stderr)


class Bar:
    """Called with each `Progress`; `close` ends the line."""

    def __init__(self) -> None:
        try:
            from tqdm.auto import tqdm
        except ImportError:
            self._tqdm: Any = None
        else:
            self._tqdm = tqdm
        self._bar: Any = None
        self._has_line = False

    def __call__(self, progress: Progress) -> None:
        error = "" if progress.error is None else f"error {100 * progress.error:.2g} %"
        if self._tqdm is not None:
            if self._bar is None:
                shape = "{l_bar}{bar}| {n:.1f}/{total} [{elapsed}<{remaining}{postfix}]" if progress.spp else None
                self._bar = self._tqdm(total=progress.spp, unit="spp", bar_format=shape, leave=False)
            self._bar.set_postfix_str(error, refresh=False)
            self._bar.update(progress.samples - self._bar.n)
        elif sys.stderr.isatty():
            total = "" if progress.spp is None else f"/{progress.spp}"
            print(f"\r{progress.samples:.1f}{total} samples a pixel  {error}  ", end="", file=sys.stderr, flush=True)
            self._has_line = True

    def close(self) -> None:
        """Takes the bar away."""
        if self._bar is not None:
            self._bar.close()
        if self._has_line:
            print(file=sys.stderr)
