#!/usr/bin/env python3
"""Makes the site's page of a notebook from its stored cells and outputs.

    tools/notebook_page.py [--execute] docs/manual/first_steps.ipynb

writes docs/manual/first_steps.md, and pictures to docs/images/first_steps_1.png and so on. --execute runs the notebook first
and stores its outputs, with the packages weft and nbclient. Else the standard library of Python 3.10 is enough.
"""

import base64
import json
import pathlib
import sys


def text_of(value):
    return "".join(value)  # a string, or its lines


def page_of(notebook):
    """(text of the page, {name of a picture: bytes}); warnings and progress (stderr) are left out."""
    parts, pictures = [], {}
    for cell in json.loads(notebook.read_text(encoding="utf-8"))["cells"]:
        source = text_of(cell["source"])
        parts.append(source if cell["cell_type"] == "markdown" else f"```python\n{source}\n```")
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            if "image/png" in data:
                name = f"{notebook.stem}_{len(pictures) + 1}.png"
                pictures[name] = base64.b64decode(text_of(data["image/png"]))
                parts.append(f"![Output](../images/{name})")
            elif output.get("name") == "stdout" or "text/plain" in data:
                text = text_of(output.get("text", data.get("text/plain"))).rstrip("\n")
                parts.append(f"```text\n{text}\n```")
    return "\n\n".join(parts) + "\n", pictures


def execute(notebook):
    import nbclient
    import nbformat
    contents = nbformat.read(notebook, as_version=4)
    metadata = contents.metadata.copy()
    nbclient.execute(contents, timeout=600, record_timing=False)
    contents.metadata = metadata  # without the versions of this machine
    nbformat.write(contents, notebook)


def main():
    notebook = pathlib.Path(sys.argv[-1])
    if "--execute" in sys.argv:
        execute(notebook)
    text, pictures = page_of(notebook)
    notebook.with_suffix(".md").write_text(text, encoding="utf-8")
    for name, content in pictures.items():
        (notebook.parent.parent / "images" / name).write_bytes(content)


if __name__ == "__main__":
    main()
