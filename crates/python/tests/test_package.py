"""The package as a whole: its examples run, its types are right, and its stubs forget nothing."""

from __future__ import annotations

import ast
import doctest
import importlib
import importlib.util
import pathlib
import pkgutil
import subprocess
import sys
from types import ModuleType

import pytest
import tyndall
from tyndall import _tyndall

PACKAGE = pathlib.Path(tyndall.__file__).parent
SOURCES = pathlib.Path(__file__).parents[1]


def modules() -> list[ModuleType]:
    """All modules that can be imported here; those of optional packages may not be there."""
    found = [tyndall]
    for module in pkgutil.walk_packages(tyndall.__path__, "tyndall."):
        try:
            found.append(importlib.import_module(module.name))
        except ImportError as error:
            assert error.name and not error.name.startswith("tyndall"), error
    return found


class Finder(doctest.DocTestFinder):
    """Finds the examples of the compiled classes too, which say that they are of `tyndall`."""

    def _from_module(self, module: ModuleType, object: object) -> bool:
        return getattr(object, "__module__", None) == module.__name__ or super()._from_module(module, object)


@pytest.mark.parametrize("module", modules(), ids=lambda module: module.__name__)
def test_examples_run(module: ModuleType) -> None:
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS)
    for test in Finder().find(module):
        runner.run(test)
    assert runner.failures == 0


def test_the_compiled_classes_have_examples() -> None:
    for kind in (tyndall.Volume, tyndall.Scene, tyndall.Accumulation):
        assert ">>> " in (kind.__doc__ or ""), kind


def stubs() -> dict[str, set[str]]:
    """The names in the stub of the compiled module, and those in its classes."""
    tree = ast.parse((PACKAGE / "_tyndall.pyi").read_text())
    names: dict[str, set[str]] = {}
    for node in tree.body:
        if isinstance(node, ast.ClassDef):
            names[node.name] = {inner.name for inner in node.body if isinstance(inner, ast.FunctionDef)}
        elif isinstance(node, ast.FunctionDef):
            names[node.name] = set()
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value is None:
            names[node.target.id] = set()
    return names


def test_the_stub_has_all_names_and_no_others() -> None:
    named = stubs()
    public = {name for name in vars(_tyndall) if not name.startswith("_")} | {"__version__"}
    assert set(named) == public
    ordinary = {
        "__delitem__",
        "__radd__",
        "__module__",
        "__doc__",
        "__new__",
        "__repr__",
        "__hash__",
        "__ne__",
        "__lt__",
        "__le__",
        "__gt__",
        "__ge__",
    }
    for name in public:
        value = getattr(_tyndall, name)
        if isinstance(value, type) and not issubclass(value, BaseException):
            assert set(vars(value)) - ordinary == named[name] - ordinary, name


def test_the_example_of_the_readme_runs() -> None:
    readme = (pathlib.Path(__file__).parents[3] / "README.md").read_text()
    code = readme.split("```python\n")[1].split("```")[0]
    # The same with hardly a sample.
    shortened = code.replace("spp=16", "time=1").replace("time=60", "time=1")
    assert shortened.count("time=1") == 2
    exec(compile(shortened, "README.md", "exec"), {})  # noqa: S102
    assert pathlib.Path("smoke.exr").stat().st_size > 0


@pytest.mark.skipif(importlib.util.find_spec("mypy") is None, reason="mypy is not installed")
def test_types_are_right(tmp_path: pathlib.Path) -> None:
    program = tmp_path / "program.py"
    program.write_text(
        "import numpy as np\n"
        "import tyndall\n\n"
        "volume = tyndall.Volume(np.zeros((8, 8, 8)), spacing='1 mm')\n"
        "scene = tyndall.Scene({'volume': {'file': volume}})\n"
        "picture = tyndall.render(scene, spp=4, progress=lambda progress: print(progress.samples))\n"
        "print(picture.image.mean(), picture.layers['Depth'].shape, (picture.accumulation + picture.accumulation).samples)\n"
    )
    checked = subprocess.run(
        [
            sys.executable,
            "-m",
            "mypy",
            "--strict",
            "--cache-dir",
            str(tmp_path),
            "--ignore-missing-imports",
            str(PACKAGE),
            str(program),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert checked.returncode == 0, checked.stdout + checked.stderr


@pytest.mark.skipif(importlib.util.find_spec("ruff") is None, reason="ruff is not installed")
def test_the_code_is_clean() -> None:
    folders = [str(SOURCES / "python"), str(SOURCES / "tests")]
    checked = subprocess.run(
        [sys.executable, "-m", "ruff", "check", "--no-cache", *folders], capture_output=True, text=True, check=False
    )
    assert checked.returncode == 0, checked.stdout
