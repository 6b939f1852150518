#!/usr/bin/env python3
"""The third-party code in wheels, from the one list python/third_party.json.

third_party.py           writes THIRD_PARTY.md
third_party.py WHEEL     compares the page and a repaired wheel's libraries and licences with the list; exit 1 if they differ
"""

import json
import pathlib
import re
import sys
import zipfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
ENTRIES = json.loads((ROOT / "python/third_party.json").read_text())


def page() -> str:
    lines = ["# Third-party code in the Python wheels", "", "Licence texts: `python/licenses/`, in wheels beside this page.", "",
             "| name | in the wheel as | licence | copyright |", "|---|---|---|---|"]
    for entry in ENTRIES:
        place = f"`{entry['library']}`, a shared library" if entry["library"] else "compiled in"
        lines.append(f"| [{entry['name']}]({entry['source']}) | {place} | {entry['license']} | {entry['copyright']} |")
    return "\n".join(lines) + "\n"


def differences(wheel: str) -> list[str]:
    names = zipfile.ZipFile(wheel).namelist()
    found = {re.sub(r"[-.].*", "", pathlib.Path(name).name) for name in names if ".libs/lib" in name}
    listed = {entry["library"] for entry in ENTRIES if entry["library"]}
    result = [f"{name} is in the wheel and not in python/third_party.json" for name in sorted(found - listed)]
    result += [f"{name} is in python/third_party.json and not in the wheel" for name in sorted(listed - found)]
    texts = {f"{name}.txt" for entry in ENTRIES for name in entry["license"].split(" and ")}
    for text in sorted(texts | {"THIRD_PARTY.md", "LICENSE"}):
        if not any(name.endswith("/" + text) and ".dist-info/" in name for name in names):
            result.append(f"the wheel has no {text}")
    if (ROOT / "THIRD_PARTY.md").read_text() != page():
        result.append("THIRD_PARTY.md is not what tools/third_party.py writes")
    return result


if len(sys.argv) == 1:
    (ROOT / "THIRD_PARTY.md").write_text(page())
else:
    wrong = differences(sys.argv[1])
    print("\n".join(wrong), file=sys.stderr, end="\n" if wrong else "")
    sys.exit(bool(wrong))
