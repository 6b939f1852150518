"""The notebook of first steps runs, and the site's page of it is the stored one."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import pytest
import weft

TREE = Path(__file__).parents[2]
NOTEBOOK = TREE / "docs" / "manual" / "first_steps.ipynb"


def has_graphics() -> bool:
    try:
        weft.Camera(size=(8, 8)).render(weft.World())
    except weft.GraphicsError:
        return False
    return True


def test_the_page_is_made_from_the_notebook() -> None:
    spec = importlib.util.spec_from_file_location("notebook_page", TREE / "tools" / "notebook_page.py")
    assert spec and spec.loader
    tool = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tool)
    text, pictures = tool.page_of(NOTEBOOK)
    again = "run tools/notebook_page.py docs/manual/first_steps.ipynb"
    assert NOTEBOOK.with_suffix(".md").read_text(encoding="utf-8") == text, again
    stored = {file.name: file.read_bytes() for file in (TREE / "docs" / "images").glob("first_steps_*.png")}
    assert stored == pictures, again
    assert len(pictures) == 5
    assert NOTEBOOK.stat().st_size < 400_000


def test_the_notebook_runs(tmp_path: Path) -> None:
    for package in ("nbclient", "ipykernel", "matplotlib"):
        if importlib.util.find_spec(package) is None:
            pytest.skip(f"the Python package {package} is missing")
    if not has_graphics():
        pytest.skip("EGL or OpenGL 3.3 is missing")
    import nbclient
    import nbformat

    notebook = nbformat.read(NOTEBOOK, as_version=4)
    stored = [text_outputs(cell) for cell in json.loads(NOTEBOOK.read_text(encoding="utf-8"))["cells"]]
    client = nbclient.NotebookClient(
        notebook, timeout=250, kernel_name="python3", resources={"metadata": {"path": str(tmp_path)}}
    )
    client.execute()
    again = "run tools/notebook_page.py --execute docs/manual/first_steps.ipynb"
    assert [text_outputs(cell) for cell in notebook.cells] == stored, again  # the same bits on every machine
    kinds = [output.data for cell in notebook.cells for output in cell.get("outputs", []) if "data" in output]
    assert sum("image/png" in data for data in kinds) == 5


def text_outputs(cell: object) -> list[str]:
    """Printed text and plain results; not those of pictures, which depend on the renderer and on matplotlib."""
    found = []
    for output in cell.get("outputs", []):  # type: ignore[attr-defined]
        data = output.get("data", {})
        if output.get("name") == "stdout" or ("text/plain" in data and "image/png" not in data):
            text = output.get("text", data.get("text/plain"))
            found.append(text if isinstance(text, str) else "".join(text))
    return found
