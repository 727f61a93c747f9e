"""Meshes."""

from __future__ import annotations

import os
from typing import Any, Union

import numpy

from . import _limn, _text
from ._limn import Field, Mesh


def mesh_from_triangles(positions: Any, triangles: Any, *, vertex_colors: Any = None) -> Mesh:
    """A mesh of triangles: positions (n, 3), world units; triangles (m, 3), vertices counter-clockwise seen from outside; vertex_colors
    (n, 3), linear RGB. Copied."""
    corners = numpy.asarray(triangles)
    if corners.ndim != 2 or corners.shape[1] != 3:
        raise _text.refuse("triangles", corners.shape, "has the wrong shape", "an array of shape (n, 3)")
    sizes = numpy.full(len(corners), 3, dtype=numpy.int32)
    return Mesh(positions, sizes, corners.reshape(-1), vertex_colors=vertex_colors)


def read_mesh(file: Union[str, "os.PathLike[str]"]) -> Mesh:
    """Reads .obj, .ply, .stl, .off, .gltf or .glb."""
    return _limn.read_mesh(_text.path(file))


def tessellate(field: Field, level: int = 3) -> Mesh:
    """A mesh of a field's surface, refined 0 to 8 times, its vertices on the surface."""
    if isinstance(level, bool) or not isinstance(level, int) or not 0 <= level <= 8:
        raise _text.refuse("level", level, "out of range", "a whole number from 0 to 8")
    return _limn.tessellate(field, level)
