"""What the documentation shows runs: the blocks of a page are one program."""

from __future__ import annotations

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
