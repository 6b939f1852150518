# SPDX-License-Identifier: GPL-3.0-or-later
"""A bake: gathers frames a few at a time, and follows the engine's process. Everything happens in poll()."""

import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import weft
from weft.bake import Cache, MotionReader, MotionWriter
from weft.bake import Job as Inputs

from . import cache
from .gather import Gather, folder_of
from .refused import Refused

_GATHER_SECONDS = 0.1  # of a poll
_PATIENCE = 0.5  # with an engine that has not begun [s]

current: "Job | None" = None  # the one of the panel


def _python() -> str:
    """Blender's own Python."""
    if Path(sys.executable).name.startswith("python"):
        return sys.executable
    found = sorted(Path(sys.prefix, "bin").glob(f"python{sys.version_info[0]}.{sys.version_info[1]}*"))
    if not found:
        raise Refused(f"Blender's Python is not in {sys.prefix}/bin; install Blender with its own Python")
    return str(found[0])


def _environment() -> dict[str, str]:
    folders = {str(Path(module.__file__).parents[1]): None for module in (weft, np)}
    return {**os.environ, "PYTHONPATH": os.pathsep.join(folders)}


class Job:
    """A bake of a scene. Raises Refused if it cannot begin.

    `poll` until it returns False. Then `outcome` is "done", "cancelled", "failed" or "refused", and `words` the report.
    """

    def __init__(self, scene: bpy.types.Scene, layer: bpy.types.ViewLayer, *, resume: bool = False) -> None:
        self.frames, self.seconds_left, self.outcome, self.words = 0, None, "", list[str]()
        self.report: dict[str, Any] = {}
        self.gathering_seconds = 0.0
        self._cancelled_at: float | None = None
        self._scene, self._layer = scene.name, layer.name
        began = time.perf_counter()
        self._gather = Gather(scene, layer)
        self.num_frames = self._gather.num_frames
        self.folder = self._gather.folder / "job"
        if resume:
            self._check_earlier()
        else:
            self._write_inputs()
        for given, position in zip(self._gather.job.cloths, self._gather.positions, strict=True):
            cache.show(bpy.data.objects[given.name], position, Path(given.cache), self._gather.first_frame)
        self._motion = MotionWriter(self.folder, self._gather.job)
        self._end_line: dict[str, Any] | None = None
        self._start()
        self.gathering_seconds += time.perf_counter() - began

    def _write_inputs(self) -> None:
        """Also caches of the first frame, for the modifiers."""
        inputs = self._gather.job
        try:
            inputs.write(self.folder)
            frame = next(self._gather.frames(range(1)))
            for to_world, given in zip(frame[0], inputs.cloths, strict=True):
                back = np.linalg.inv(to_world)
                Path(given.cache).unlink(missing_ok=True)
                Cache(given.cache, len(given.start), inputs.first_frame, 0).add_frame(given.start @ back[:3, :3].T + back[:3, 3])
        except OSError as error:
            raise Refused(f"{self.folder} cannot be written: {error.strerror}; choose another cache folder") from None
        except weft.InputError as error:
            raise Refused(f"{error}; choose another cache folder") from None

    def _check_earlier(self) -> None:
        """Raises Refused if the scene is no longer that of the job in the folder."""
        inputs = self._gather.job
        try:
            earlier = Inputs.read(self.folder)
        except weft.InputError as error:
            raise Refused(f"There is no bake to resume: {error}") from None
        if difference := earlier.difference(inputs):
            raise Refused(f"Since the bake began this has changed: {difference}; bake again")
        motion = MotionReader(self.folder, inputs)
        last = motion.num_frames - 1
        for _, pins, bodies in self._gather.frames(range(max(last, 0), last + 1)):
            row = motion.frame(last)
            same = [np.allclose(row[f"pins_{n}"], points, atol=1e-5) for n, points in enumerate(pins)]
            same += [np.allclose(row[f"collider_{n}"], points, atol=1e-5) for n, points in enumerate(bodies)]
            if not all(same):
                raise Refused("Since the bake began the animation has changed; bake again")

    def _start(self) -> None:
        for name in ("lines.txt", "errors.txt"):  # an earlier engine may still write to its own
            (self.folder / name).unlink(missing_ok=True)
        with open(self.folder / "lines.txt", "wb") as lines, open(self.folder / "errors.txt", "wb") as errors:
            self._process = subprocess.Popen(
                [_python(), "-s", "-m", "weft.bake", str(self.folder)], stdin=subprocess.PIPE, stdout=lines, stderr=errors,
                env=_environment(), start_new_session=True,
            )  # fmt: skip
        self._lines = open(self.folder / "lines.txt", encoding="utf-8")  # noqa: SIM115
        self._partial = ""

    @property
    def is_running(self) -> bool:
        return not self.outcome

    @property
    def pid(self) -> int:
        """Of the engine's process."""
        return self._process.pid

    def poll(self) -> bool:
        """Gathers for a tenth of a second, and reads what the engine says. False: the bake has ended."""
        if not self.is_running:
            return False
        ended = self._process.poll() is not None  # before the last lines are read
        self._read_lines()
        if ended:
            self._finish()
        elif self._cancelled_at is not None:
            if self.frames == 0 and time.perf_counter() - self._cancelled_at > _PATIENCE:
                self._process.kill()  # cloth is put on, which takes seconds; nothing is lost
        elif self._process.stdin and not self._process.stdin.closed:
            self._gather_some()
        return self.is_running

    def _gather_some(self) -> None:
        began = time.perf_counter()
        frames = self._gather.frames(range(self._motion.num_frames, self.num_frames))
        try:
            for frame in frames:
                self._motion.add_frame(*frame)
                if time.perf_counter() - began > _GATHER_SECONDS:
                    break
        except Refused as error:
            self.words = [f"{error}."]
            self.cancel()
            return
        finally:
            frames.close()  # the scene is as it was
            self.gathering_seconds += time.perf_counter() - began
        if self._motion.num_frames == self.num_frames:
            self._end_input()

    def _end_input(self) -> None:
        self._motion.close()
        self._process.stdin.close()

    def _read_lines(self) -> None:
        *lines, self._partial = (self._partial + self._lines.read()).split("\n")
        for text in lines:
            line = json.loads(text)
            if line["event"] == "end":
                self._end_line = line
            else:
                self.frames, self.seconds_left = line["frames"], line.get("seconds_left")
        if lines:
            self._refresh()

    def _refresh(self) -> None:
        """Shows the frame again that has just been baked, if Blender stands at it."""
        scene = bpy.data.scenes.get(self._scene)
        for given in self._gather.job.cloths:
            cloth = bpy.data.objects.get(given.name)
            if cloth and scene and scene.frame_current >= self._gather.first_frame + self.frames - 1:
                cloth.update_tag()

    def cancel(self) -> None:
        """Asks the engine to end; poll() until it has. The frames that are there stay, and Resume goes on."""
        if self.is_running:
            self._cancelled_at = time.perf_counter()
            self._process.terminate()

    def _finish(self) -> None:
        self._motion.close()
        self._lines.close()
        if self._process.stdin:
            self._process.stdin.close()
        if self._end_line:
            self.report = self._end_line
            self.outcome = "failed" if self.words else self.report["outcome"]
            self.words += self.report["words"]
            self.frames = self.report.get("frames", self.frames)
        elif self._cancelled_at is not None:  # before it had begun
            self.outcome = "failed" if self.words else "cancelled"
            self.words.append("Cancelled: no frame is baked.")
        else:
            self.outcome = "failed"
            said = (self.folder / "errors.txt").read_text(errors="replace").strip().splitlines()
            reason = said[-1] if said else f"exit code {self._process.returncode}"
            self.words.append(f"The engine ended unexpectedly ({reason}); Resume goes on from its last checkpoint.")
        gone = [given for given in self._gather.job.cloths if given.name not in bpy.data.objects]
        if gone and self.outcome == "done":
            self.outcome = "failed"
            self.words = [f'"{given.name}" is no longer there; its frames are in {given.cache}.' for given in gone] + self.words
        scene = bpy.data.scenes.get(self._scene)
        if scene:
            scene.weft.report = "\n".join(self.words)
        self._refresh()


def free(scene: bpy.types.Scene) -> None:
    """Removes the modifiers, the caches and the job of a scene."""
    for thing in scene.objects:
        modifier = cache.find_modifier(thing)
        if modifier and thing.weft.role == "CLOTH":
            thing.modifiers.remove(modifier)
    folder = folder_of(scene)
    shutil.rmtree(folder / "job", ignore_errors=True)
    for file in folder.glob("*.pc2"):
        file.unlink()
    if folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()
    scene.weft.report = ""


def can_resume(scene: bpy.types.Scene) -> bool:
    try:
        return (folder_of(scene) / "job" / "job.json").is_file()
    except Refused:
        return False
