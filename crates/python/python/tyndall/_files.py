"""Scenes as bytes, to be made anew elsewhere: what pickling does.

A scene's text names each file by a hash of its content, so that equal files are there once, and a place that has a file already
needs no second copy.
"""

from __future__ import annotations

import os
import pathlib
import tempfile
from collections.abc import Mapping
from functools import cache

from tyndall._tyndall import Scene, Volume


def contents(
    parts: tuple[str, Mapping[str, pathlib.Path], Mapping[str, Volume]],
) -> tuple[str, dict[str, bytes], dict[str, Volume]]:
    """The parts of a scene with the bytes of its files in place of their paths."""
    text, paths, volumes = parts
    return text, {name: path.read_bytes() for name, path in paths.items()}, dict(volumes)


def scene(text: str, files: Mapping[str, bytes], volumes: Mapping[str, Volume]) -> Scene:
    """The scene of `contents`."""
    folder = pathlib.Path(_folder().name)
    for name, content in files.items():
        place(folder, name, content)
    return Scene.from_toml(text, folder=folder, volumes=dict(volumes))


def place(folder: pathlib.Path, name: str, content: bytes) -> pathlib.Path:
    """Puts a file of a scene into a folder, under its name `HASH/cloud.vdb`, in one step, unless it is there."""
    path = folder / name
    if not path.exists():
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as unfinished:
            unfinished.write(content)
        os.replace(unfinished.name, path)
    return path


@cache
def _folder() -> tempfile.TemporaryDirectory[str]:
    """Where files of unpickled scenes are, as long as this process lives."""
    return tempfile.TemporaryDirectory(prefix="tyndall-")
