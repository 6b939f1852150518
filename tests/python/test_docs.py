"""The Python blocks of the pages run from top to bottom, in a folder of their own; and the examples."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
import weft

TREE = Path(__file__).parents[2]
PAGES = ["README.md", "docs/manual/python.md", "docs/manual/farm.md", "python/README.md"]
EXAMPLES = sorted((TREE / "python" / "examples").glob("*.py"))


def blocks_of(page: Path) -> list[tuple[int, str]]:
    """Python blocks with the lines before them, so that a traceback shows the page's line."""
    text = page.read_text(encoding="utf-8")
    found = re.finditer(r"^```python\n(.*?)^```$", text, re.DOTALL | re.MULTILINE)
    return [(text.count("\n", 0, match.start(1)), match.group(1)) for match in found]


@pytest.mark.parametrize("page", PAGES)
def test_the_blocks_of_a_page_run(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    blocks = blocks_of(TREE / page)
    assert blocks, f"{page} has no Python block"
    space: dict[str, Any] = {"__name__": "page"}
    for line, block in blocks:
        exec(compile("\n" * line + block, str(TREE / page), "exec"), space)


def test_python_and_cpp_in_the_readme_print_the_same(capsys: pytest.CaptureFixture[str]) -> None:
    program = Path(os.environ.get("WEFT_PROGRAM", "")).parents[1:2]
    cpp = program[0] / "tests" / "snippet_README_md_1" if program else Path()
    if not cpp.is_file():
        pytest.skip("the README's C++ program is missing: WEFT_PROGRAM names no build folder with it")
    printed = subprocess.run([str(cpp)], capture_output=True, text=True, timeout=60, check=True).stdout
    ((_, block),) = blocks_of(TREE / "README.md")
    exec(block, {"__name__": "page"})
    heights = [re.search(r"center of mass: (\S+) m", text) for text in (printed, capsys.readouterr().out)]
    assert heights[0] and heights[1]
    assert float(heights[0][1]) == float(f"{float(heights[1][1]):.6g}")  # C++ prints six digits


def test_there_are_nine_examples_under_40_lines() -> None:
    assert len(EXAMPLES) == 9
    for example in EXAMPLES:
        assert len(example.read_text(encoding="utf-8").splitlines()) < 40, example.name


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_runs(example: Path, tmp_path: Path) -> None:
    program, arguments = example.read_text(encoding="utf-8"), [str(tmp_path)]
    if "scipy" in program:
        pytest.importorskip("scipy")
    if "weft.farm" in program:
        pytest.importorskip("distributed")
        arguments.append("20")  # of 200 runs
    package = str(Path(weft.__file__).parents[1])
    environment = {**os.environ, "PYTHONPATH": package, "PYTHONWARNINGS": "error::UserWarning"}
    done = subprocess.run(
        [sys.executable, str(example), *arguments], capture_output=True, text=True, timeout=250, env=environment,
        cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.strip() and not done.stderr, done.stderr
