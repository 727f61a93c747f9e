"""Groups of settings that several calls have in common, as fields."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Mapping, Optional, Sequence, Tuple, Union

from . import _text
from ._limn import ResolvedCamera
from ._text import Fields

Vector = Union[Sequence[float], Any]
Names = Union[str, Sequence[str], None]


@dataclass(frozen=True)
class Camera:
    """Where a picture is seen from. What is left out is framed from what is drawn.

    eye, target: (3,), world units. up: (3,), or an axis such as "z". fov: vertical field of view, degrees. ortho: the picture's height
    in world units, for parallel rays; not together with fov. size: width and height, pixels. azimuth, elevation: where to look from, in
    degrees about up and above the horizon, in place of an eye. roll: degrees, clockwise. zoom: about the picture's middle. margin: share
    of the picture left free on each side.
    """

    eye: Optional[Vector] = None
    target: Optional[Vector] = None
    up: Union[Vector, str, None] = None
    fov: Optional[float] = None
    ortho: Optional[float] = None
    size: Optional[Tuple[int, int]] = None
    azimuth: Optional[float] = None
    elevation: Optional[float] = None
    roll: Optional[float] = None
    zoom: Optional[float] = None
    margin: Optional[float] = None

    def __post_init__(self) -> None:
        for name in ("eye", "target", "up"):
            value = getattr(self, name)
            if value is not None and not (name == "up" and isinstance(value, str)) and len(_text.numbers(name, value).split(",")) != 3:
                raise _text.refuse(name, _text.numbers(name, value), "is no vector", "three numbers")


AnyCamera = Union[Camera, ResolvedCamera]


def camera_fields(
    fields: Fields, camera: Optional[AnyCamera], size: Any, view: Optional[int] = None, views: Optional[int] = None
) -> None:
    """size over the camera's own."""
    if isinstance(camera, ResolvedCamera):
        given = {flag.lstrip("-"): text for flag, text in camera._call.items()}
        own_size = given.pop("size")
        fields.extend(given.items())
        size = own_size if size is None else size
    elif camera is not None and not isinstance(camera, Camera):
        raise _text.refuse("camera", type(camera).__name__, "is no camera", "a limn.Camera")
    elif camera is not None:
        for name in ("eye", "target", "up"):
            value = getattr(camera, name)
            _text.add(fields, name, None if value is None else _text.numbers(name, value))
        for name in ("fov", "ortho", "azimuth", "elevation", "roll", "zoom", "margin"):
            value = getattr(camera, name)
            _text.add(fields, name, None if value is None else _text.number(value))
        size = camera.size if size is None else size
    _text.add(fields, "size", None if size is None else _text.size(size))
    _text.add(fields, "views", None if views is None else _text.number(views))
    _text.add(fields, "view", None if view is None else _text.number(view))


def surface_fields(
    fields: Fields,
    surface: Names = None,
    voxels: Optional[int] = None,
    voxel_size: Optional[float] = None,
    half_width: Optional[float] = None,
    gradient: Optional[str] = None,
    level: Union[int, str, None] = None,
    scheme: Optional[str] = None,
    normals: Optional[str] = None,
    smooth_angle: Optional[float] = None,
    grids: Names = None,
    local: Optional[float] = None,
) -> None:
    """How surfaces are modelled."""
    _text.add_all(fields, "surface", _text.listed("surface", surface))
    _text.add(fields, "voxels", None if voxels is None else _text.number(voxels))
    _text.add(fields, "voxel_size", None if voxel_size is None else _text.number(voxel_size))
    _text.add(fields, "half_width", None if half_width is None else _text.number(half_width))
    _text.add(fields, "gradient", gradient)
    _text.add(fields, "level", None if level is None else _text.number(level))
    _text.add(fields, "scheme", scheme)
    _text.add(fields, "normals", normals)
    _text.add(fields, "smooth_angle", None if smooth_angle is None else _text.number(smooth_angle))
    _text.add_all(fields, "grid", _text.listed("grids", grids))
    _text.add(fields, "local", None if local is None else _text.number(local))


def method_fields(fields: Fields, methods: Names, parameters: Optional[Mapping[str, Any]], name: str = "method") -> None:
    """Outline methods and their parameters."""
    _text.add_all(fields, name, _text.listed("methods", methods))
    for key, value in (parameters or {}).items():
        fields.append(("set", f"{key}={_text.parameter(value)}"))


def picture_fields(fields: Fields, samples: Optional[int], background: Any) -> None:
    """What a picture shows beside the scene."""
    _text.add(fields, "samples", None if samples is None else _text.number(samples))
    _text.add(fields, "background", None if background is None else _text.color("background", background))


def look_fields(fields: Fields, look: Optional[str], shading: Optional[str], transparent: bool, ink_only: bool, mattes: bool) -> None:
    """How a picture is coloured."""
    _text.add(fields, "look", None if look is None else str(look))
    _text.add(fields, "shading", None if shading is None else str(shading))
    for name, value in (("transparent", transparent), ("ink_only", ink_only), ("mattes", mattes)):
        if value is not False:
            fields.append((name, _text.flag(value)))


def execution_fields(fields: Fields, threads: Optional[int], max_memory: Union[int, str, None] = None) -> None:
    """What a call may take."""
    _text.add(fields, "threads", None if threads is None else _text.number(threads))
    _text.add(fields, "max_memory", None if max_memory is None else _text.number(max_memory))


def line_fields(
    fields: Fields,
    lines: Names,
    threshold: Optional[float],
    crease_angle: Optional[float],
    smooth: bool,
    suggestive_angle: Optional[float] = None,
    suggestive_slope: Optional[float] = None,
    ridge_strength: Optional[float] = None,
    fair: Optional[float] = None,
) -> None:
    """Which lines."""
    _text.add_all(fields, "lines", _text.listed("lines", lines))
    for name, value in (
        ("lines_threshold", threshold),
        ("crease_angle", crease_angle),
        ("suggestive_angle", suggestive_angle),
        ("suggestive_slope", suggestive_slope),
        ("ridge_strength", ridge_strength),
        ("fair", fair),
    ):
        _text.add(fields, name, None if value is None else _text.number(value))
    if smooth is not False:
        fields.append(("smooth", _text.flag(smooth)))


def drawing_fields(
    fields: Fields,
    hidden: bool = False,
    layers: Any = None,
    curves: Optional[str] = None,
    fit: Optional[float] = None,
    page: Any = None,
    style: Any = None,
) -> None:
    """How lines are drawn."""
    if layers is not None:
        text = layers if isinstance(layers, str) else "..".join(_text.number(one) for one in layers) if hasattr(layers, "__len__") else _text.number(layers)
        fields.append(("layers", text))
    if hidden is not False:
        fields.append(("hidden", _text.flag(hidden)))
    _text.add(fields, "curves", curves)
    _text.add(fields, "fit", None if fit is None else _text.number(fit))
    _text.add(fields, "page", None if page is None else page if isinstance(page, str) else _text.size(page) + "mm")
    _text.add(fields, "style", None if style is None else _text.path(style))
