"""What the documentation shows runs: the blocks of a page are one program."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parents[3] / "docs"


@pytest.mark.parametrize("name", ["python.md"])
def test_the_blocks_of_a_page_run_in_order(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    text = (DOCS / name).read_text(encoding="utf-8")
    blocks = list(re.finditer(r"^```python\n(.*?)^```$", text, re.DOTALL | re.MULTILINE))
    assert blocks
    names: dict[str, object] = {}
    for block in blocks:
        # Empty lines before it, so that what fails is told with its line of the page.
        before = "\n" * text.count("\n", 0, block.start(1))
        exec(compile(before + block.group(1), str(DOCS / name), "exec"), names)  # noqa: S102


def test_the_notebook_runs_and_its_page_shows_it() -> None:
    notebook = json.loads((DOCS / "notebooks" / "first_light.ipynb").read_text(encoding="utf-8"))
    page = (DOCS / "notebooks" / "first_light.md").read_text(encoding="utf-8")
    cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    assert all(f"```python\n{cell}\n```" in page for cell in cells), "the page is old: run docs/notebooks/render"
    for picture in re.findall(r"!\[png\]\((.*?)\)", page):
        assert (DOCS / "notebooks" / picture).stat().st_size < 150_000
    pytest.importorskip("matplotlib").use("agg")
    names: dict[str, object] = {}
    for number, cell in enumerate(cells):
        # The same in small: a few samples of few pixels.
        small = re.sub(r"resolution=\(\d+, \d+\)", "resolution=(48, 30)", cell)
        small = re.sub(r"\b64\b(?!j)", "2", small).replace("(2, 128)", "(2, 4)").replace("20_000", "500")
        exec(compile(small, f"cell {number}", "exec"), names)  # noqa: S102
