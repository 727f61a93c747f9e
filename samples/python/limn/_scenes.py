"""Scenes from what a caller has."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Sequence, Tuple, Union

from . import _limn, _text
from ._limn import Field, LevelSet, Mesh, Model, Scene


@dataclass(frozen=True)
class Object:
    """One object of a scene: a Field, a Mesh or a LevelSet, and how it looks.

    color: linear RGB, (3,). material: an id, for lines between materials. scheme: makes a Mesh a subdivision cage ("catmark", "loop" or
    "bilinear"). level: of the cage or the tessellation, 0 to 8.
    """

    source: Union[Field, Mesh, LevelSet]
    name: str = "object"
    color: Sequence[float] = (0.8, 0.8, 0.8)
    material: int = 0
    scheme: Optional[str] = None
    level: Optional[int] = None

    def _described(self) -> Dict[str, Any]:
        material = self.material
        if isinstance(material, bool) or not isinstance(material, int) or not -(2**31) <= material < 2**31:
            raise _text.refuse("material", material, "is no material", "a whole number")
        return {
            "source": self.source,
            "name": str(self.name),
            "color": self.color,
            "material": material,
            "scheme": self.scheme or "",
            "level": self.level,
        }


Sources = Union[Object, Field, Mesh, LevelSet]


def _object(source: Any, index: int) -> Object:
    return source if isinstance(source, Object) else Object(source, name=f"object {index + 1}")


def scene(objects: Union[Sources, Sequence[Sources]], name: str = "scene") -> Scene:
    """A scene of one or several objects. Meshes that are inside out are turned round. Nothing is copied but the list."""
    listed: List[Any] = list(objects) if isinstance(objects, (list, tuple)) else [objects]
    return _limn.scene_of(str(name), [_object(one, index)._described() for index, one in enumerate(listed)])


def load(
    file: Union[str, "os.PathLike[str]"], *, grids: Any = None, scheme: Optional[str] = None, level: Optional[int] = None
) -> Scene:
    """Reads a scene file (.toml), a mesh (.obj .ply .stl .off .gltf .glb), a volume (.vdb .nvdb), a formula (.vm), or makes a built-in
    scene (limn.names("scenes")), for several calls to draw. grids: of a volume, by name. scheme, or a level above 0, makes a mesh a
    subdivision cage."""
    fields: _text.Fields = []
    _text.add_all(fields, "grid", _text.listed("grids", grids))
    _text.add(fields, "scheme", scheme)
    _text.add(fields, "level", None if level is None else _text.number(level))
    return _limn.read_scene(_text.path(file), fields)


def source_of(given: Any) -> Any:
    """What the extension module draws: a str, a Scene or a Model."""
    if isinstance(given, (Scene, Model)):
        return given
    if isinstance(given, (str, os.PathLike)):
        return _text.path(given)
    if isinstance(given, (Object, Field, Mesh, LevelSet, list, tuple)):
        return scene(given)
    return given


def objects_of(given: Scene) -> List[Tuple[str, Any, Tuple[float, float, float], int]]:
    """Name, source, colour and material of each object."""
    return given._objects()
