# SPDX-License-Identifier: GPL-3.0-or-later
"""Weft in Blender: cloth baked by the engine in a process of its own, shown by a Mesh Cache modifier."""

from . import operators, panel, properties


def register() -> None:
    properties.register()
    operators.register()
    panel.register()


def unregister() -> None:
    panel.unregister()
    operators.unregister()
    properties.unregister()
