"""Light in clouds, smoke, fire, fog, milk and air, by Monte Carlo: pictures with the standard error of every pixel."""

from tyndall import measure, phase
from tyndall._errors import Error, FileError
from tyndall._tyndall import __version__

__all__ = ["Error", "FileError", "__version__", "measure", "phase"]
