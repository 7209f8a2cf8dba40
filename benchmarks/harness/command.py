"""Running a program once: what it printed, the seconds it took, the memory it needed."""

import os
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path


class Failed(Exception):
    """A run that did not come about, with one line that says why."""


@dataclass(frozen=True)
class Run:
    """What one run gave."""

    output: str
    wall: float
    # Seconds of all its threads.
    cpu: float
    # The most memory it held at a time, in bytes.
    memory: int


def run(command, environ=None):
    """Runs a program to its end; raises `Failed` with the last line of its complaints."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        start = time.perf_counter()
        process = subprocess.Popen([str(part) for part in command], stdout=out, stderr=err, env=environ)
        try:
            _, status, usage = os.wait4(process.pid, 0)
        except BaseException:
            process.kill()
            process.wait()
            raise
        wall = time.perf_counter() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        said, complained = (read(file) for file in (out, err))
    if process.returncode != 0:
        last = (complained.strip() or said.strip() or "it said nothing").splitlines()[-1]
        raise Failed(f"{Path(command[0]).name} ended with status {process.returncode}: {last}")
    # Linux counts memory in KiB.
    return Run(said, wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024)


def read(file):
    """A file's text from its start."""
    file.seek(0)
    return file.read().decode(errors="replace")
