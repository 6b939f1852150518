"""Scenes: scene files as objects, and their runs."""

from __future__ import annotations

import json
import math
import os
import re
import tempfile
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._arguments import choose, whole
from ._pictures import Camera, Picture, draw_frame, write_video
from ._progress import show_progress
from ._world import World

_SPRING_KEYS = {"structural": "spring_structural", "shear": "spring_shear", "bend": "spring_bend"}


def _toml(value: Any, name: str) -> str:
    """A value as TOML."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, _core.Fabric):
        numbers = value._asdict()
        return _toml({key: number for key, number in numbers.items() if not isinstance(number, list) or number}, name)
    if isinstance(value, _core.Springs):
        return _toml({_SPRING_KEYS.get(key, key): number for key, number in value._asdict().items()}, name)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        if not math.isfinite(value):
            raise _core.InputError(f"{name}: expected a finite number, found {value}")
        return repr(value)
    if isinstance(value, (str, os.PathLike)):
        return json.dumps(os.fspath(value), ensure_ascii=False)
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(key)} = {_toml(item, name)}" for key, item in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(_toml(item, name) for item in value) + "]"
    raise _core.InputError(f"{name}: expected a number, text, list or dict, found {value!r:.60}")


def _key(key: object) -> str:
    text = str(key)
    return text if re.fullmatch(r"[A-Za-z0-9_-]+", text) else json.dumps(text, ensure_ascii=False)


def _parameters(table: str) -> dict[str, dict[str, Any]]:
    """The keys of a table, without its subtables' keys."""
    prefix = f"{table}." if table else ""
    found: dict[str, dict[str, Any]] = {}
    for parameter in _core.parameters():
        key = parameter["key"]
        if key.startswith(prefix) and "." not in key[len(prefix) :]:
            found.setdefault(key[len(prefix) :], parameter)
    return found


class Section:
    """A table of a scene. Its keys are attributes, as in scene files: `scene.solver.steps_per_frame = 2`.

    A key that is not given reads as its default. Setting one checks the whole scene: SceneError, without change, if
    it would not be valid.
    """

    _scene: _core.Scene
    _path: str

    def __init__(self, core: _core.Scene, path: str) -> None:
        object.__setattr__(self, "_scene", core)
        object.__setattr__(self, "_path", path)

    def _values(self) -> Any:
        value: Any = json.loads(self._scene.to_json())
        for step in re.findall(r"[^.\[\]]+", self._path):
            if isinstance(value, list):
                value = value[int(step)]
            else:
                value = value.get(step, {}) if isinstance(value, dict) else {}
        return value

    def _table(self) -> str:
        return re.sub(r"\[\d+\]", "", self._path)

    def __getattr__(self, key: str) -> Any:
        if key.startswith("_"):
            raise AttributeError(key)
        values = self._values()
        if isinstance(values, dict) and key in values:
            value = values[key]
            if isinstance(value, dict):
                return Section(self._scene, f"{self._path}.{key}")
            if isinstance(value, list) and value and isinstance(value[0], dict):
                return [Section(self._scene, f"{self._path}.{key}[{n}]") for n in range(len(value))]
            return value
        known = _parameters(self._table())
        if key not in known:
            raise AttributeError(f"{self._table()} has no key {key!r}; there are {', '.join(known)}")
        if known[key]["kind"] == "table":
            return Section(self._scene, f"{self._path}.{key}")
        usual = known[key]["default"]
        return json.loads(usual) if usual else None

    def __setattr__(self, key: str, value: Any) -> None:
        self._scene.set(f"{self._path}.{_key(key)}={_toml(value, key)}")

    def __dir__(self) -> list[str]:
        return list(_parameters(self._table()))

    def __repr__(self) -> str:
        return f"<weft {self._path}: {self._values()}>"


class Scene(Section):
    """A scene file with its changes, always valid. Attributes are the keys of its table [scene].

    >>> scene = load_scene("paper/fig6_ball")
    >>> scene.name, scene.num_frames
    ('paper/fig6_ball', 180)
    >>> scene.duration = 1
    >>> scene.cloths[0].fabric.friction = 0.1
    >>> scene.num_frames
    60
    """

    def __init__(self, core: _core.Scene) -> None:
        super().__init__(core, "scene")

    @property
    def name(self) -> str:
        """The file's name without ending, with its folders below one called "scenes"."""
        return self._scene.name

    @property
    def num_frames(self) -> int:
        """Duration times frames per second, at least 1."""
        return self._scene.num_frames

    @property
    def frames_per_second(self) -> float:
        """[1/s]"""
        return self._scene.frames_per_second

    @property
    def steps_per_frame(self) -> int:
        """Steps of a frame."""
        return self._scene.steps_per_frame

    @property
    def dt(self) -> float:
        """Length of a step [s]."""
        return self._scene.step

    @property
    def cloths(self) -> list[Section]:
        """Its cloths, in the order of the file."""
        return self._list("cloth")

    @property
    def colliders(self) -> list[Section]:
        """Its colliders, in the order of the file."""
        return self._list("collider")

    @property
    def contacts(self) -> list[Section]:
        """Settings of pairs of bodies."""
        return self._list("contact")

    @property
    def wind(self) -> Section:
        """Wind and air."""
        return Section(self._scene, "wind")

    @property
    def solver(self) -> Section:
        """Integrator and its settings."""
        return Section(self._scene, "solver")

    def _list(self, key: str) -> list[Section]:
        return [Section(self._scene, f"{key}[{n}]") for n in range(len(self.to_dict().get(key, [])))]

    def set(self, assignment: str) -> None:
        """Changes a value as `weft run --set` does: `scene.set("cloth[0].fabric=denim")`. Raises SceneError."""
        choose(assignment, "assignment", str, 'text such as "cloth[0].fabric=denim"')
        self._scene.set(assignment)

    def to_dict(self) -> dict[str, Any]:
        """The document, with its changes and without defaults."""
        values: dict[str, Any] = json.loads(self._scene.to_json())
        return values

    def write(self, file: str | os.PathLike[str]) -> None:
        """Writes a scene file that reads back as this scene, without comments. Raises InputError if it cannot."""
        self._scene.write(os.fspath(file))

    def copy(self) -> Scene:
        """An independent copy."""
        return Scene(self._scene.copy())

    def world(self, *, threads: int = 1) -> World:
        """Its world, ready for the first step of `dt`. Raises InputError if a mesh cannot be used."""
        core, _ = self._scene.build()
        world = World._of(core)
        world.threads = threads
        return world

    def __copy__(self) -> Scene:
        return self.copy()

    def __deepcopy__(self, memo: dict[int, Any]) -> Scene:
        return self.copy()

    def __repr__(self) -> str:
        return f"<weft.Scene {self.name!r}, {self.num_frames} frames>"


def load_scene(source: str | os.PathLike[str], *, set: Mapping[str, Any] | None = None) -> Scene:
    """A scene: a file, the name of a shipped one ("drape_sphere"), or TOML text with a line break.

    set: changes by their path, checked together: `{"cloth[0].fabric": "denim"}`. Raises SceneError with every
    mistake, and InputError if there is no such scene.
    """
    choose(source, "source", (str, os.PathLike), "a file, a scene's name or TOML text")
    text = os.fspath(source)
    core = _core.Scene.parse(text, "scene.toml") if "\n" in text else _core.Scene.load(text)
    scene = Scene(core)
    for key, value in (set or {}).items():
        scene.set(f"{key}={_toml(value, key)}")
    return scene


def scenes() -> list[str]:
    """Names of the shipped scenes."""
    return _core.scene_names()


class _Positions(Mapping[str, NDArray[np.float32]]):
    """Positions of a run by cloth: (frames + 1, n, 3) float32 [m], mapped from disk, not loaded."""

    def __init__(self, folder: Path, cloths: list[dict[str, Any]], frames: int) -> None:
        self._folder, self._cloths, self._frames = folder, {cloth["name"]: cloth for cloth in cloths}, frames

    def __getitem__(self, cloth: str) -> NDArray[np.float32]:
        entry = self._cloths[cloth]
        shape = (self._frames + 1, entry["vertices"], 3)
        return np.memmap(self._folder / entry["positions"], "<f4", "r", offset=32, shape=shape)

    def __iter__(self) -> Iterator[str]:
        return iter(self._cloths)

    def __len__(self) -> int:
        return len(self._cloths)


class Run:
    """Results of a run: a folder, from `weft.run`, `weft run` or `open_run`."""

    def __init__(self, folder: Path, keeper: tempfile.TemporaryDirectory[str] | None = None) -> None:
        self.folder = folder
        self._keeper = keeper  # a folder that goes with this object
        with open(folder / "run.json", encoding="utf-8") as stream:
            self._contents: dict[str, Any] = json.load(stream)
        with open(folder / self._contents["report"], encoding="utf-8") as stream:
            self.report: dict[str, Any] = json.load(stream)
        self._animation: _core.AnimationFile | None = None

    def __repr__(self) -> str:
        return f"<weft.Run of {self.name!r}: {self.num_frames} frames, {self.outcome}, in {str(self.folder)!r}>"

    @property
    def name(self) -> str:
        """The scene's name."""
        name: str = self._contents["scene"]
        return name

    @property
    def num_frames(self) -> int:
        """Frames that were simulated; the start is another one, frame 0."""
        frames: int = self._contents["frames"]
        return frames

    @property
    def frames_per_second(self) -> float:
        """[1/s]"""
        rate: float = self._contents["fps"]
        return rate

    @property
    def outcome(self) -> str:
        """ "done", "interrupted" or "failed"."""
        outcome: str = self.report["outcome"]
        return outcome

    @property
    def problems(self) -> list[Any]:
        """Reasons not to trust the result; empty: none found."""
        problems: list[Any] = self.report["problems"]
        return problems

    @property
    def positions(self) -> Mapping[str, NDArray[np.float32]]:
        """By cloth: (frames + 1, n, 3) float32 [m], mapped from disk, not loaded. Frame 0 is the start."""
        return _Positions(self.folder, self._contents["cloths"], self.num_frames)

    @property
    def _recorded(self) -> _core.AnimationFile:
        if self._animation is None:
            if not self._contents["animation"]:
                raise _core.InputError("the run has no animation.glb; run it with glb=True")
            self._animation = _core.AnimationFile(str(self.folder / self._contents["animation"]))
        return self._animation

    def picture(self, frame: int = -1, *, camera: Camera | None = None, size: tuple[int, int] = (640, 480)) -> Picture:
        """A frame as an RGB array (height, width, 3), which shows itself in a notebook; -1: the last frame.

        Without a camera, one that shows all frames. Raises GraphicsError without EGL and OpenGL.
        """
        return draw_frame(self._recorded, frame, camera, size)

    def video(
        self, file: str | os.PathLike[str], *, camera: Camera | None = None, size: tuple[int, int] = (640, 480),
        every: int = 1,
    ) -> None:  # fmt: skip
        """Writes the run as .mp4, .webp or .gif, in its own time. Needs ffmpeg."""
        write_video(file, self._recorded, camera, size, every)


def open_run(folder: str | os.PathLike[str]) -> Run:
    """The results in a folder. Raises InputError if there are none."""
    path = Path(folder)
    if not (path / "run.json").is_file():
        raise _core.InputError(f"{path} holds no run: there is no run.json")
    return Run(path)


def run(
    scene: Scene | str | os.PathLike[str],
    *,
    frames: int | None = None,
    threads: int = 1,
    out: str | os.PathLike[str] | None = None,
    progress: bool | Callable[[int, int, float, float], object] = False,
    glb: bool = True,
    obj: bool = False,
    audit: bool = False,
    check_passages: bool = True,
    start_from: str | os.PathLike[str] | Run | None = None,
    unfinished: Literal["refuse", "resume", "discard"] = "refuse",
    checkpoint_every: int | None = None,
) -> Run:
    """Simulates a scene to its end and checks every frame, as `weft run` does.

    frames: instead of the scene's own number. threads: they never change the result. out: folder of the results;
    without it they go when the returned object does. progress: True shows a bar (tqdm where it is installed); or a
    function of frame, number of frames, seconds spent and seconds left, which ends the run by returning False.
    glb, obj: whether to write animation.glb, and an OBJ file per cloth and frame. audit: also the energy balance.
    check_passages: also the check for tunnelling within steps. start_from: a frame of an earlier run, as "DIR@60" or
    "DIR@last"; of a Run its last one. The cloths begin with the positions of that frame, by their names, and with
    velocities from differences of frames: an approximation, while a resumed run continues exactly. unfinished: what to
    do about a run in `out` that was killed: refuse it, resume it from its last checkpoint, or discard it.
    checkpoint_every: frames between checkpoints; by default as many as take 30 s.

    Ctrl-C ends it within a step; the frames made so far are in `out`. Raises InputError for bad input. A failed step
    ends it with the outcome "failed".

    >>> result = run("paper/fig6_ball", frames=2)
    >>> result.outcome, result.positions["cloth"].shape
    ('done', (3, 1089, 3))
    """
    if not isinstance(scene, Scene):
        scene = load_scene(scene)
    num_threads, num_frames = whole(threads, "threads"), None if frames is None else whole(frames, "frames")
    if num_threads < 1 or (num_frames is not None and num_frames < 1):
        raise _core.InputError("threads and frames: expected at least 1")
    start = start_from.folder if isinstance(start_from, Run) else start_from
    if start is not None:
        choose(start, "start_from", (str, os.PathLike), 'a Run or text such as "out/flag@60"')
    every = None if checkpoint_every is None else whole(checkpoint_every, "checkpoint_every")
    keeper = tempfile.TemporaryDirectory(prefix="weft-", ignore_cleanup_errors=True) if out is None else None
    folder = Path(keeper.name if keeper else os.fspath(out))  # type: ignore[arg-type]
    tell = show_progress(scene.name, "frame") if progress is True else progress or None
    _core.run(
        scene._scene, num_frames, num_threads, bool(audit), bool(check_passages),
        str(folder), bool(glb), bool(obj), "" if start is None else os.fspath(start), str(unfinished), every, tell,
    )  # fmt: skip
    return Run(folder, keeper)
