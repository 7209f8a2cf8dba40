"""Scenes on their way to the workers: each content once, under its hash."""

from __future__ import annotations

import hashlib
import os
import pathlib
import pydoc
import uuid
from collections.abc import Mapping, MutableMapping
from dataclasses import dataclass
from typing import Any
from weakref import WeakValueDictionary

import distributed

from tyndall import __version__
from tyndall._errors import Error, FileError
from tyndall._tyndall import Scene, Volume
from tyndall.dask._types import Client, Future
from tyndall.dask._work import Outline


@dataclass(frozen=True)
class SentScene:
    """Where a scene is on the cluster; as long as this is held."""

    outline: Future
    contents: tuple[Future, ...]
    paths: Mapping[str, str]
    """Where the files are here, by the names that they have there."""

    def here(self, message: str) -> str:
        """A message of a worker about a file, with the name that the file has here."""
        for name, path in self.paths.items():
            message = message.replace(name, path)
        return message


class Sending:
    """Sends scenes; what is there already, for another scene, is not sent again."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._there: MutableMapping[str, Future] = WeakValueDictionary()

    def send(self, scene: Scene, to_all: bool) -> SentScene:
        """Sends a scene: to all workers, who pass it on to each other, or to one, from which others have it when they need it."""
        self._client.wait_for_workers(1)
        text, paths, volumes = scene.to_parts()
        files = {name: pathlib.Path(path) for name, path in paths.items()}
        # The names of files have hashes of their contents in them.
        key = _hash(repr((text, [volume.hash for volume in volumes.values()])).encode())
        outline = Outline(key, text, tuple(files), tuple(volumes))
        contents = [self._content(name, path, to_all) for name, path in files.items()]
        contents += [self._volume(volume, to_all) for volume in volumes.values()]
        return SentScene(self._put(outline, key, to_all), tuple(contents), {name: str(path) for name, path in files.items()})

    def _content(self, name: str, path: pathlib.Path, to_all: bool) -> Future:
        there = self._known(name)
        try:
            return there if there is not None else self._put(path.read_bytes(), name, to_all)
        except OSError as error:
            raise FileError(f"{path}: {os.strerror(error.errno or 0)}") from error

    def _volume(self, volume: Volume, to_all: bool) -> Future:
        there = self._known(volume.hash)
        return there if there is not None else self._put(volume.to_bytes(), volume.hash, to_all)

    def _known(self, key: str) -> Future | None:
        there = self._there.get(key)
        # Otherwise it was lost with the workers that had it.
        return there if there is not None and there.status == "finished" else None

    def _put(self, content: Outline | bytes, key: str, to_all: bool) -> Future:
        # What was lost and is sent anew needs a new name.
        name = f"tyndall-scene-{key.replace('/', '-')}-{uuid.uuid4().hex[:8]}"
        sent: Mapping[str, Future] = self._client.scatter({name: content}, broadcast=to_all)
        self._there[key] = sent[name]
        return sent[name]


def check(client: Client) -> None:
    """Waits for a worker, and sees that all have this version of tyndall: others might draw other samples.

    The scheduler needs it as well, to read the tasks that it hands on.
    """
    is_client = isinstance(client, distributed.Client)
    if not is_client or client.asynchronous:
        raise Error("client: give a dask.distributed.Client, such as distributed.Client(), that is not asynchronous")
    client.wait_for_workers(1)
    # Of Python's own library, as a function of tyndall could not be sent to where there is none.
    versions: dict[str, Any] = client.run(pydoc.locate, "tyndall.__version__", on_error="return")
    versions["the scheduler"] = client.run_on_scheduler(pydoc.locate, "tyndall.__version__")
    for where, version in versions.items():
        if version != __version__:
            what = "no tyndall" if version is None else f"tyndall {version}" if isinstance(version, str) else f"a broken tyndall ({version})"
            raise Error(f"{where} has {what}, and this is tyndall {__version__}; install {__version__} in the environment of scheduler and workers")


def _hash(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()[:32]
