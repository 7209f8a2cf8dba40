"""Where things are, and the Python that the harness runs in.

The commands need numpy, OpenEXR and matplotlib, and for the peers mitsuba and bpy. They run themselves again in a
virtual environment that has them: the one that --venv or TYNDALL_BENCH_VENV names, or one made in target/bench/venv.
A peer that cannot be installed there is a peer that is missing.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

BENCHMARKS = Path(__file__).resolve().parents[1]
ROOT = BENCHMARKS.parent
SHARED = ROOT.parent / "shared"
WORK = ROOT / "target" / "bench"

NEEDED = ["numpy", "OpenEXR", "matplotlib"]
PEERS = {"mitsuba": "mitsuba==3.9.1", "bpy": "bpy==5.0.1"}

_INSIDE = "TYNDALL_BENCH_INSIDE"


def enter(venv, peers):
    """Goes on in the virtual environment, with the packages of `peers` if they can be had; returns at once if there."""
    if os.environ.get(_INSIDE):
        return
    chosen = venv or os.environ.get("TYNDALL_BENCH_VENV")
    folder = Path(chosen) if chosen else WORK / "venv"
    python = folder / "bin" / "python"
    if chosen and not python.exists():
        sys.exit(f"--venv {folder}: there is no bin/python in it; name a virtual environment, or none to have one made")
    if not chosen:
        make(folder, python, peers)
    os.environ[_INSIDE] = "1"
    os.environ["PYTHONDONTWRITEBYTECODE"] = "1"
    os.execv(python, [str(python), *sys.argv])


def make(folder, python, peers):
    """Makes the virtual environment, or adds to it what it lacks."""
    if not python.exists():
        print(f"making a virtual environment in {folder}", file=sys.stderr)
        subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
    if not has(python, NEEDED) and pip(python, NEEDED) != 0:
        sys.exit(f"could not install {', '.join(NEEDED)}; name a virtual environment that has them with --venv")
    for module in peers:
        if not has(python, [module]) and pip(python, [PEERS[module]]) != 0:
            print(f"{PEERS[module]} could not be installed: left out", file=sys.stderr)


def has(python, modules):
    """Whether the modules can be found, without loading them."""
    look = f"import importlib.util as u, sys; sys.exit(not all(u.find_spec(m) for m in {modules!r}))"
    return subprocess.run([str(python), "-c", look]).returncode == 0


def pip(python, packages):
    """Exit status of an installation."""
    print(f"installing {' '.join(packages)}", file=sys.stderr)
    return subprocess.run([str(python), "-m", "pip", "install", "--quiet", *packages]).returncode


def llvm_library():
    """Path of an LLVM that Mitsuba's LLVM variants can load: DRJIT_LIBLLVM_PATH, or the newest that is installed, or None."""
    named = os.environ.get("DRJIT_LIBLLVM_PATH")
    if named:
        return named if Path(named).exists() else None
    folders = [Path("/usr/lib"), Path("/usr/lib64"), *Path("/usr/lib").glob("*-linux-gnu")]
    found = [path for folder in folders for path in folder.glob("libLLVM*.so*")]

    def version(path):
        number = re.search(r"(\d+)", path.name)
        return int(number.group(1)) if number else 0

    # Versions before 17 abort on processors with AVX-512.
    found = [path for path in found if version(path) >= 17]
    return str(max(found, key=version)) if found else None
