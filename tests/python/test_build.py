"""What the package's build says where it cannot compile."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

SOURCES = Path(__file__).resolve().parents[2] / "python"


def complaint(build: Path, *options: str, **environment: str) -> str:
    if shutil.which("cmake") is None:
        pytest.skip("cmake is missing")
    done = subprocess.run(
        ["cmake", "-S", str(SOURCES), "-B", str(build), *options],
        env={**os.environ, **environment}, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode != 0
    return " ".join(done.stderr.split())


def test_a_missing_compiler_is_told_with_its_package(tmp_path: Path) -> None:
    assert "by: apt-get install g++" in complaint(tmp_path, CXX=str(tmp_path / "none"))


def test_missing_libraries_are_told_in_one_sentence(tmp_path: Path) -> None:
    told = complaint(tmp_path, "-Dinclude_of_libeigen3-dev=0", "-Dinclude_of_libtbb-dev=0")
    assert "Weft is compiled here and lacks packages; on Debian or Ubuntu install them by:" in told
    assert "apt-get install libeigen3-dev libtbb-dev" in told


@pytest.mark.parametrize(("system", "processor"), [("Darwin", "arm64"), ("Windows", "AMD64"), ("Linux", "aarch64")])
def test_other_platforms_are_told_in_one_sentence(tmp_path: Path, system: str, processor: str) -> None:
    told = complaint(tmp_path, f"-DWEFT_PLATFORM={system} {processor}")
    assert f"Weft's Python package runs on Linux x86-64 only, not on {system} {processor}." in told
