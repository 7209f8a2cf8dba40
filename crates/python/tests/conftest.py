"""What tests share: a small scene, and the command if it is built."""

from __future__ import annotations

import os
import pathlib
import shutil
import subprocess
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

REPOSITORY = pathlib.Path(__file__).resolve().parents[3]


@pytest.fixture(autouse=True)
def in_empty_folder(tmp_path: pathlib.Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Tests write where nothing else is."""
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def ball() -> dict[str, Any]:
    """A ball of smoke under an even light, small enough to be rendered in no time."""
    return {
        "camera": {"position": [0, 0, 4], "target": [0, 0, 0], "vertical_fov": 35},
        "film": {"resolution": [20, 14]},
        "volume": [{"sphere": {"center": [0, 0, 0], "radius": 1}, "mu_t": 2, "albedo": 0.8}],
        "light": [{"type": "constant", "radiance": 1}],
    }


@pytest.fixture
def blob() -> np.ndarray[Any, Any]:
    """A lopsided blob, different along every axis."""
    x, y, z = np.indices((12, 20, 16)).astype("f4")
    return np.exp(-((x - 4) ** 2 + (y - 9) ** 2 / 2 + (z - 9) ** 2) / 12).astype("f4")


@pytest.fixture
def command() -> str:
    """The command `tyndall` of this checkout; tests that need it are skipped where it is not built."""
    named = os.environ.get("TYNDALL_COMMAND")
    for path in [named] if named else [REPOSITORY / "target" / kind / "tyndall" for kind in ("release", "debug")]:
        if shutil.which(path):
            return str(path)
    pytest.skip("the command is not built: cargo build")


@pytest.fixture
def answer(command: str) -> Callable[..., str]:
    """What the command prints, given its arguments."""

    def run(*arguments: str) -> str:
        done = subprocess.run([command, *arguments], check=False, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run
