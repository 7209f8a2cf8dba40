"""What has to be known of the machine and the programs for a figure to mean something later."""

import datetime
import os
import platform
import re
import subprocess

from . import environment


def describe(tyndall, threads):
    """A dictionary for the head of a run. Nothing in it names the machine or its user."""
    return {
        "date": datetime.datetime.now(datetime.timezone.utc).strftime("%Y-%m-%dT%H:%M:%SZ"),
        "processor": processor(),
        "cores": os.cpu_count(),
        "threads": threads,
        "load_at_start": round(os.getloadavg()[0], 2),
        "system": f"{platform.system()} {platform.machine()}",
        "tyndall": output([str(tyndall), "--version"]),
        "commit": commit(),
        "rustc": output(["rustc", "--version"]),
        "python": platform.python_version(),
    }


def command(name, arguments):
    """The command without the options that name places on this machine."""
    kept, places = [], ("--venv", "--tyndall", "--out")
    for at, argument in enumerate(arguments):
        of_place = at > 0 and arguments[at - 1] in places
        if argument.split("=")[0] not in places and not of_place:
            kept.append(argument)
    return " ".join([f"benchmarks/{name}", *kept])


def processor():
    """The model of the processor, as the system calls it."""
    try:
        with open("/proc/cpuinfo") as file:
            for line in file:
                if line.startswith("model name"):
                    return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def folder_name():
    """DATE-PROCESSOR, such as 2026-11-22-amd-epyc."""
    plain = re.sub(r"\((r|tm)\)|cpu|processor|@.*|\d+-core", " ", processor().lower())
    return datetime.date.today().isoformat() + "-" + re.sub(r"[^a-z0-9]+", "-", plain).strip("-")


def commit():
    """The commit that is checked out, marked if tracked files differ from it."""
    name = output(["git", "-C", str(environment.ROOT), "rev-parse", "--short", "HEAD"])
    changed = output(["git", "-C", str(environment.ROOT), "status", "--porcelain", "--untracked-files=no"])
    return name and name + (" with changes" if changed else "")


def output(command):
    """What a command says, or None if it cannot be run."""
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return None
