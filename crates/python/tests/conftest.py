"""What several tests need: the command, if it has been built."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest


def binary() -> str | None:
    """The command: that of this checkout, most recently built, or else the installed one."""
    target = Path(__file__).parents[3] / "target"
    built = [path for profile in ("debug", "release") if (path := target / profile / "tyndall").is_file()]
    if built:
        return str(max(built, key=lambda path: path.stat().st_mtime))
    return shutil.which("tyndall")


@pytest.fixture(scope="session")
def command() -> Callable[..., str]:
    """Runs the command with arguments, and returns what it prints."""
    program = binary()
    if program is None:
        pytest.skip("the command is not built: cargo build")

    def run(*arguments: str) -> str:
        done = subprocess.run([program, *arguments], check=False, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run
