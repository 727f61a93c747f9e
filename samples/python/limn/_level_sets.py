"""Level sets."""

from __future__ import annotations

import os
import tempfile
from typing import Any, Optional, Sequence, Tuple, Union

import numpy

from . import _limn, _text
from ._limn import Field, LevelSet, Mesh


def _number(field: str, value: Any) -> float:
    if isinstance(value, bool):
        raise _text.refuse(field, value, "is no number", "a number above 0")
    try:
        return float(value)
    except (TypeError, ValueError):
        raise _text.refuse(field, value, "is no number", "a number above 0") from None


def level_set(
    source: Union[Field, Mesh], *, voxels: Optional[int] = None, voxel_size: Optional[float] = None, half_width: float = 3.0
) -> LevelSet:
    """Samples of a field's or a mesh's distance in a narrow band. voxels: along the longest side, 4 to 8192, default 256; or voxel_size,
    world units. half_width: of the band, voxels, at least 1.8."""
    if voxels is not None and (isinstance(voxels, bool) or not isinstance(voxels, int)):
        raise _text.refuse("voxels", voxels, "is no whole number", "a whole number from 4 to 8192")
    size = None if voxel_size is None else _number("voxel_size", voxel_size)
    width = _number("half_width", half_width)
    if isinstance(source, Mesh):
        return _limn.level_set_of_mesh(source, voxels, size, width)
    if isinstance(source, Field):
        return _limn.level_set_of_field(source, voxels, size, width)
    raise _text.refuse("source", type(source).__name__, "has no distance", "a Field or a Mesh")


def level_set_from_array(values: Any, *, voxel_size: float, origin: Sequence[float] = (0.0, 0.0, 0.0), half_width: float = 3.0) -> LevelSet:
    """A level set from distances (nx, ny, nz), world units, negative inside, at origin + voxel_size * (i, j, k). What is farther from the
    surface than half_width voxels only counts by its sign. Values on the array's faces must be above 0. Copied, to 32 bits."""
    return _limn.level_set_from_array(values, _number("voxel_size", voxel_size), origin, _number("half_width", half_width))


def level_set_from_voxels(
    indices: Any, values: Any, *, voxel_size: float, origin: Sequence[float] = (0.0, 0.0, 0.0), half_width: Optional[float] = None
) -> LevelSet:
    """A level set from its active voxels alone: indices (n, 3), whole numbers; values (n,), distances in world units, negative inside; the
    node (0, 0, 0) stands at origin. half_width: of the band, voxels; missing: as far as the values go. Copied, to 32 bits."""
    width = None if half_width is None else _number("half_width", half_width)
    return _limn.level_set_from_voxels(indices, values, _number("voxel_size", voxel_size), origin, width)


def level_set_to_array(level_set: LevelSet, margin: int = 1) -> Tuple["_limn.Array", "_limn.Array"]:
    """Values (nx, ny, nz), 32 bits, of the box around the active voxels and margin voxels more; and where the first stands, (3,), world
    units. Beyond the band the values are plus or minus its half width. Copies."""
    if isinstance(margin, bool) or not isinstance(margin, int) or not 0 <= margin <= 1024:
        raise _text.refuse("margin", margin, "out of range", "0 to 1024 voxels")
    values, first = level_set.dense(margin)
    world_from_index = level_set.world_from_index
    return values, world_from_index[:3, :3] @ numpy.asarray(first, dtype=float) + world_from_index[:3, 3]


def read_level_set(file: Union[str, "os.PathLike[str]"], grid: str = "") -> LevelSet:
    """Reads a level set from .vdb or .nvdb; grid: its name where there are several."""
    return _limn.read_level_set(_text.path(file), str(grid))


def _openvdb() -> Any:
    try:
        import pyopenvdb  # type: ignore[import]
    except ImportError as error:
        raise ImportError("pyopenvdb is not installed; Debian's package python3-openvdb brings it") from error
    return pyopenvdb


def level_set_from_openvdb(grid: Any) -> LevelSet:
    """A level set from a FloatGrid of pyopenvdb, through a temporary .vdb file: the two share no memory."""
    openvdb = _openvdb()
    if not hasattr(grid, "gridClass"):
        raise _text.refuse("grid", type(grid).__name__, "is no grid", "a pyopenvdb.FloatGrid")
    with tempfile.TemporaryDirectory(prefix="limn-") as folder:
        file = os.path.join(folder, "grid.vdb")
        openvdb.write(file, grids=[grid])
        return read_level_set(file)


def level_set_to_openvdb(level_set: LevelSet) -> Any:
    """A FloatGrid of pyopenvdb, through a temporary .vdb file: the two share no memory."""
    openvdb = _openvdb()
    with tempfile.TemporaryDirectory(prefix="limn-") as folder:
        file = os.path.join(folder, "grid.vdb")
        level_set.write(file)
        grids, _ = openvdb.readAll(file)
        return grids[0]
