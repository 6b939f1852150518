"""Pictures of worlds and runs. OpenGL is loaded with the first picture in colour."""

from __future__ import annotations

import os
import tempfile
import threading
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arguments import choose, real, vector, whole
from ._world import World

_local = threading.local()  # a renderer belongs to one thread


def _renderer() -> _core.Renderer:
    if not hasattr(_local, "renderer"):
        _local.renderer = _core.Renderer()
    return _local.renderer  # type: ignore[no-any-return]


class Picture(np.ndarray[Any, np.dtype[np.uint8]]):
    """An RGB array (height, width, 3) uint8, sRGB, rows from the top; it shows itself in a notebook."""

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes a .png or .jpg file. Raises InputError for another ending, and if it cannot be written."""
        if self.ndim != 3 or self.shape[2] != 3 or self.dtype != np.uint8:
            found = f"found {self.shape} of {self.dtype}"
            raise _core.InputError(f"picture: expected shape (height, width, 3) of uint8, {found}")
        _core.write_picture(os.fspath(file), np.ascontiguousarray(self))

    def _repr_png_(self) -> bytes | None:
        if self.ndim != 3 or self.shape[2] != 3:
            return None
        with tempfile.TemporaryDirectory() as folder:
            file = os.path.join(folder, "picture.png")
            self.save(file)
            with open(file, "rb") as stream:
                return stream.read()


class Rendering:
    """A picture with depths and ids, in rows from the top.

    rgb: (height, width, 3) uint8, sRGB. depth: (height, width) float32, distance along the viewing direction [m],
    infinity where nothing is. ids: (height, width) int32, the index in `World.cloths`, then, counting on, in
    `World.colliders`; -1 where nothing is.
    """

    def __init__(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32], ids: NDArray[np.int32]) -> None:
        self.rgb, self.depth, self.ids = rgb.view(Picture), depth, ids

    def _repr_png_(self) -> bytes | None:
        return self.rgb._repr_png_() if len(self.rgb) else None


class Camera(_core.CameraValues):
    """A perspective (pinhole) camera; +y is up in the picture.

    position: of the eye [m]. target: in the picture's middle [m]. fov_deg: vertical field of view, in (0, 180).
    A point at z along the viewing direction, x to the right and y down, is at column width/2 + f x/z and row
    height/2 + f y/z, with f = height / (2 tan(fov_deg / 2)) [pixels].

    >>> import weft
    >>> world = weft.World()
    >>> ball = world.add_collider(weft.Sphere(radius=0.5))
    >>> seen = Camera(position=(0, 0, 3), size=(64, 48)).render(world, color=False)
    >>> round(float(seen.depth[24, 32]), 2), int(seen.ids[24, 32])
    (2.5, 0)
    """

    def __init__(
        self,
        *,
        position: ArrayLike = (1, 1, 2),
        target: ArrayLike = (0, 0, 0),
        fov_deg: float = 32.0,
        size: tuple[int, int] = (640, 480),
    ) -> None:
        choose(size, "size", (tuple, list, np.ndarray), "width and height")
        if len(size) != 2:
            raise _core.InputError(f"size: expected width and height, found {len(size)} items")
        width, height = whole(size[0], "size"), whole(size[1], "size")
        super().__init__(
            vector(position, "position"), vector(target, "target"), real(fov_deg, "fov_deg"), width, height
        )

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [pixels]."""
        return (self.width, self.height)

    def __reduce__(self) -> tuple[Any, ...]:
        return _camera_of, (self.position, self.target, self.fov_deg, self.size)

    def framing(self, world: World) -> Camera:
        """The camera with this direction, as near as shows all cloths and finite colliders of a world."""
        choose(world, "world", World, "a World")
        return _adopt(_core.frame_camera(world._core, self))

    def render(
        self,
        world: World,
        *,
        color: bool = True,
        shadows: bool = True,
        samples: int = 4,
        cloth_colors: Sequence[tuple[float, float, float]] = (),
        ground: float | None = None,
        smooth: int | None = None,
    ) -> Rendering:
        """The world as it is: colours, depths and ids.

        color: False needs no graphics; rgb is then empty. shadows: of the sun, and ambient occlusion. samples: per
        pixel, for smooth edges, 1 to 16. cloth_colors: linear red, green, blue in [0, 1] of the first cloths.
        ground: height of a ground in rgb, where no plane is [m]. smooth: Loop subdivisions of cloth in rgb, 0 to 2, with
        rounded hems; None: its triangles.

        Raises InputError for invalid values, GraphicsError for colours without EGL and OpenGL.
        """
        choose(world, "world", World, "a World")
        choose(cloth_colors, "cloth_colors", (Sequence, np.ndarray), "a list of colours")
        colors = [vector(c, "cloth_colors") for c in cloth_colors]
        height = None if ground is None else real(ground, "ground")
        loops = None if smooth is None else whole(smooth, "smooth")
        options = _core.RenderOptions(bool(color), bool(shadows), whole(samples, "samples"), colors, height, loops)
        return Rendering(*_renderer().render(world._core, self, options))


def _camera_of(position: ArrayLike, target: ArrayLike, fov_deg: float, size: tuple[int, int]) -> Camera:
    return Camera(position=position, target=target, fov_deg=fov_deg, size=size)


def _adopt(values: _core.CameraValues) -> Camera:
    return _camera_of(values.position, values.target, values.fov_deg, (values.width, values.height))


def _camera(animation: _core.AnimationFile, camera: Camera | None, size: tuple[int, int]) -> _core.CameraValues:
    return _core.frame_camera(animation, Camera(size=size)) if camera is None else camera


def _plain() -> _core.RenderOptions:
    return _core.RenderOptions(True, True, 4, [], None, None)


def draw_frame(
    animation: _core.AnimationFile, frame: int, camera: Camera | None, size: tuple[int, int]
) -> Picture:
    """A frame of a recorded run; see `Run.picture`."""
    number = whole(frame, "frame")
    index = number + animation.num_frames if number < 0 else number
    view = _camera(animation, camera, size)
    rgb, _, _ = _renderer().render_frame(animation, index, view, _plain())
    return rgb.view(Picture)


def write_video(
    file: str | os.PathLike[str], animation: _core.AnimationFile, camera: Camera | None, size: tuple[int, int],
    every: int,
) -> None:  # fmt: skip
    """A recorded run as a video; see `Run.video`."""
    view = _camera(animation, camera, size)
    _core.write_video(os.fspath(file), animation, view, _plain(), whole(every, "every"))
