"""Light in clouds, smoke, fire, fog, milk and air: pictures with the standard error of every pixel.

A scene is a dictionary with the keys of a scene file, and a volume is a NumPy array:

>>> import numpy, tyndall
>>> x, y, z = numpy.indices((32, 32, 32)) - 15.5
>>> ball = tyndall.Volume(numpy.exp(-(x**2 + y**2 + z**2) / 100), spacing=1 / 32, origin=-0.5)
>>> scene = tyndall.Scene({
...     "camera": {"position": [0, 0, 3], "target": [0, 0, 0], "vertical_fov": 25},
...     "film": {"resolution": [64, 48]},
...     "volume": {"file": ball, "mu_t": 8, "albedo": 0.9},
...     "light": {"type": "constant", "radiance": 1},
... })
>>> picture = tyndall.render(scene, spp=16, progress=False)
>>> picture.image.shape, picture.image.dtype
((48, 64, 3), dtype('float32'))
>>> bool((picture.standard_error < 0.2).all())
True
"""

from tyndall import estimators, measure, phase
from tyndall._errors import Error, FileError
from tyndall._render import load, render
from tyndall._tyndall import Accumulation, Progress, Render, Scene, Volume, __version__, schema
from tyndall.transfer_function import TransferFunction
from tyndall.volume_scene import render_volume, volume_scene

__all__ = [
    "Accumulation",
    "Error",
    "FileError",
    "Progress",
    "Render",
    "Scene",
    "TransferFunction",
    "Volume",
    "__version__",
    "estimators",
    "load",
    "measure",
    "phase",
    "render",
    "render_volume",
    "schema",
    "volume_scene",
]
