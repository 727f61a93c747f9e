"""The calls: arguments in, limn's work, results out."""

from __future__ import annotations

import json
import os
import tempfile
from typing import Any, Dict, List, Mapping, Optional, Sequence, Tuple, Union

from . import _limn, _settings, _text
from ._limn import Border, Model, Picture
from ._results import Comparison, Judgement, Lines, Measures, Plan, Study
from ._scenes import source_of
from ._settings import AnyCamera, Names

Level = Union[int, str, None]
Path = Union[str, "os.PathLike[str]"]


def model(
    scene: Any,
    *,
    surface: Optional[str] = None,
    voxels: Optional[int] = None,
    voxel_size: Optional[float] = None,
    half_width: Optional[float] = None,
    gradient: Optional[str] = None,
    level: Level = None,
    scheme: Optional[str] = None,
    normals: Optional[str] = None,
    smooth_angle: Optional[float] = None,
    grids: Names = None,
    local: Optional[float] = None,
    camera: Optional[AnyCamera] = None,
    size: Optional[Tuple[int, int]] = None,
    threads: Optional[int] = None,
    max_memory: Union[int, str, None] = None,
) -> Model:
    """Models a scene once, for several pictures of it.

    surface: a representation (limn.names("surfaces")); missing: what each object is by itself. voxels along the longest side, or
    voxel_size in world units; half_width of the band in voxels; gradient: how normals are read from level sets. level: refinements of
    cages and tessellations, 0 to 8, or "auto": as many as a picture by this camera and size shows. scheme: makes meshes cages. normals:
    "flat", "vertex" or "limit". smooth_angle: degrees. grids: of a volume. local: pixels; the model is
    fine where the border of this camera's picture runs, and coarse elsewhere: a mesh, or with surface "level_set" or "mesh_level_set"
    bricks of several voxel sizes. threads: 0 is all. max_memory: bytes, or such as "4G".
    """
    fields: _text.Fields = []
    _settings.surface_fields(fields, surface, voxels, voxel_size, half_width, gradient, level, scheme, normals, smooth_angle, grids, local)
    _settings.camera_fields(fields, camera, size)
    _settings.execution_fields(fields, threads, max_memory)
    return _limn.build(source_of(scene), fields)


def render(
    scene: Any,
    *,
    camera: Optional[AnyCamera] = None,
    size: Optional[Tuple[int, int]] = None,
    view: Optional[int] = None,
    views: Optional[int] = None,
    methods: Names = None,
    parameters: Optional[Mapping[str, Any]] = None,
    look: Optional[str] = None,
    shading: Optional[str] = None,
    samples: Optional[int] = None,
    background: Any = None,
    transparent: bool = False,
    ink_only: bool = False,
    mattes: bool = False,
    surface: Optional[str] = None,
    voxels: Optional[int] = None,
    voxel_size: Optional[float] = None,
    half_width: Optional[float] = None,
    gradient: Optional[str] = None,
    level: Level = None,
    scheme: Optional[str] = None,
    normals: Optional[str] = None,
    smooth_angle: Optional[float] = None,
    grids: Names = None,
    local: Optional[float] = None,
    threads: Optional[int] = None,
    max_memory: Union[int, str, None] = None,
) -> Picture:
    """Draws one picture, as `limn render` does. A notebook shows it.

    Its layers are numpy arrays that look at the picture's own memory. size: (width, height), pixels. view of views: one of so many
    directions spread over the sphere. methods: one or several outline methods (limn.names("methods")), the last on top; parameters:
    {"threshold": 0.3} for every method that has it, {"rim.threshold": 0.3} for one. look: methods, shading and ground that go
    together (limn.names("looks")); shading: how surfaces are coloured (limn.names("shadings")). samples: rays a pixel, 8. background: a
    colour name, "#rrggbb" or linear RGB, in the composite; missing: the composite is transparent, and shown and written over white unless
    transparent is True. ink_only: the ink alone, its coverage as alpha. mattes: which objects and materials cover each pixel, for .exr
    files (Cryptomatte). Settings of the surface as for model(); a Model takes none.
    """
    fields: _text.Fields = []
    _settings.surface_fields(fields, surface, voxels, voxel_size, half_width, gradient, level, scheme, normals, smooth_angle, grids, local)
    _settings.camera_fields(fields, camera, size, view, views)
    _settings.method_fields(fields, methods, parameters)
    _settings.picture_fields(fields, samples, background)
    _settings.look_fields(fields, look, shading, transparent, ink_only, mattes)
    _settings.execution_fields(fields, threads, max_memory)
    return _limn.render(source_of(scene), fields)


def contours(
    scene: Any,
    *,
    lines: Names = None,
    camera: Optional[AnyCamera] = None,
    size: Optional[Tuple[int, int]] = None,
    view: Optional[int] = None,
    views: Optional[int] = None,
    threshold: Optional[float] = None,
    crease_angle: Optional[float] = None,
    smooth: bool = False,
    suggestive_angle: Optional[float] = None,
    suggestive_slope: Optional[float] = None,
    ridge_strength: Optional[float] = None,
    fair: Optional[float] = None,
    tolerance_px: Optional[float] = None,
    surface: Optional[str] = None,
    voxels: Optional[int] = None,
    voxel_size: Optional[float] = None,
    half_width: Optional[float] = None,
    level: Optional[int] = None,
    scheme: Optional[str] = None,
    grids: Names = None,
    threads: Optional[int] = None,
) -> Lines:
    """Solves the lines of the true surface, as `limn contours` does: contours, boundaries, creases, intersections, visible and hidden.

    lines: classes (limn.names("lines")), or "all"; missing: those drawn by default. threshold: N.V of the class rim. crease_angle:
    degrees. smooth: meshes as the smooth surface through their vertices. fair: waves of meshes as short as so many mean edges are smoothed
    away, such as a scan's noise. tolerance_px: how far polylines may lie from the curves,
    0.005. surface: the lines of a model ("mesh", "level_set" or "mesh_level_set") in place of the surface itself.
    """
    fields: _text.Fields = []
    _settings.surface_fields(fields, surface, voxels, voxel_size, half_width, None, level, scheme, None, None, grids)
    _settings.camera_fields(fields, camera, size, view, views)
    _settings.line_fields(fields, lines, threshold, crease_angle, smooth, suggestive_angle, suggestive_slope, ridge_strength, fair)
    _text.add(fields, "tolerance_px", None if tolerance_px is None else _text.number(tolerance_px))
    _settings.execution_fields(fields, threads)
    return Lines(_limn.contours(source_of(scene), fields))


def truth(
    scene: Any,
    *,
    threshold: Optional[float] = None,
    tolerance_px: Optional[float] = None,
    reference: Optional[str] = None,
    camera: Optional[AnyCamera] = None,
    size: Optional[Tuple[int, int]] = None,
    view: Optional[int] = None,
    views: Optional[int] = None,
    scheme: Optional[str] = None,
    grids: Names = None,
    threads: Optional[int] = None,
) -> Border:
    """Solves the true border of a scene in double precision, never from a picture.

    threshold: N.V where the rim's ink ends, 0.4; 0: the silhouette alone. tolerance_px: how far the polylines may lie from the curves,
    0.005. reference, of meshes that are no cages and of volumes: "given", the file as it is, or "smooth", the surface that was meant.
    """
    fields: _text.Fields = []
    _settings.surface_fields(fields, scheme=scheme, grids=grids)
    _settings.camera_fields(fields, camera, size, view, views)
    for name, value in (("threshold", threshold), ("tolerance_px", tolerance_px)):
        _text.add(fields, name, None if value is None else _text.number(value))
    _text.add(fields, "reference", reference)
    _settings.execution_fields(fields, threads)
    return _limn.truth(source_of(scene), fields)


def border(
    scene: Any,
    *,
    threshold: Optional[float] = None,
    camera: Optional[AnyCamera] = None,
    size: Optional[Tuple[int, int]] = None,
    view: Optional[int] = None,
    views: Optional[int] = None,
    surface: Optional[str] = None,
    voxels: Optional[int] = None,
    voxel_size: Optional[float] = None,
    half_width: Optional[float] = None,
    gradient: Optional[str] = None,
    level: Level = None,
    scheme: Optional[str] = None,
    normals: Optional[str] = None,
    smooth_angle: Optional[float] = None,
    grids: Names = None,
    threads: Optional[int] = None,
) -> Border:
    """Measures the border that a model shows, by its own rays between the pixels: curves at sub-pixel precision.

    threshold: N.V where the rim's ink ends, 0.4; 0: the silhouette alone. Settings of the surface as for model(); a Model takes none.
    """
    fields: _text.Fields = []
    _settings.surface_fields(fields, surface, voxels, voxel_size, half_width, gradient, level, scheme, normals, smooth_angle, grids)
    _settings.camera_fields(fields, camera, size, view, views)
    _text.add(fields, "threshold", None if threshold is None else _text.number(threshold))
    _settings.execution_fields(fields, threads)
    return _limn.border(source_of(scene), fields)


def measure(
    scene: Any,
    *,
    camera: Optional[AnyCamera] = None,
    size: Optional[Tuple[int, int]] = None,
    view: Optional[int] = None,
    views: Optional[int] = None,
    methods: Names = None,
    parameters: Optional[Mapping[str, Any]] = None,
    samples: Optional[int] = None,
    reference: Optional[str] = None,
    surface: Optional[str] = None,
    voxels: Optional[int] = None,
    voxel_size: Optional[float] = None,
    half_width: Optional[float] = None,
    gradient: Optional[str] = None,
    level: Optional[int] = None,
    scheme: Optional[str] = None,
    normals: Optional[str] = None,
    smooth_angle: Optional[float] = None,
    grids: Names = None,
    local: Optional[float] = None,
    threads: Optional[int] = None,
) -> Measures:
    """What the metrics (limn.names("metrics")) say of one model: its picture against the reference's, its border against the true one.

    surface: the representation that is measured; missing: the scene's own. local: pixels, as for model(). The numbers are those of `limn compare`.
    """
    fields: _text.Fields = []
    _settings.surface_fields(fields, surface, voxels, voxel_size, half_width, gradient, level, scheme, normals, smooth_angle, grids, local)
    _settings.camera_fields(fields, camera, size, view, views)
    _settings.method_fields(fields, methods, parameters)
    _settings.picture_fields(fields, samples, None)
    _text.add(fields, "reference", reference)
    _settings.execution_fields(fields, threads)
    return Measures(_limn.measure(source_of(scene), fields))


def compare(
    scene: Any,
    *,
    folder: Optional[Path] = None,
    surfaces: Names = None,
    methods: Names = None,
    parameters: Optional[Mapping[str, Any]] = None,
    samples: Optional[int] = None,
    background: Any = None,
    reference: Optional[str] = None,
    camera: Optional[AnyCamera] = None,
    size: Optional[Tuple[int, int]] = None,
    voxels: Optional[int] = None,
    voxel_size: Optional[float] = None,
    half_width: Optional[float] = None,
    gradient: Optional[str] = None,
    level: Level = None,
    scheme: Optional[str] = None,
    normals: Optional[str] = None,
    smooth_angle: Optional[float] = None,
    grids: Names = None,
    local: Optional[float] = None,
    threads: Optional[int] = None,
    max_memory: Union[int, str, None] = None,
) -> Comparison:
    """Draws the border from every representation, by one method or by several, and measures it, as `limn compare` does.

    folder: where each model's layers go as EXR, with sheet.png, rows.json and report.html; missing: nothing is kept in files. surfaces:
    only these representations. methods: a column each, or "all"; missing: rim. The other settings as for render().
    """
    fields: _text.Fields = []
    _settings.surface_fields(fields, surfaces, voxels, voxel_size, half_width, gradient, level, scheme, normals, smooth_angle, grids, local)
    _settings.camera_fields(fields, camera, size)
    _settings.method_fields(fields, methods, parameters, "column")
    _settings.picture_fields(fields, samples, background)
    _text.add(fields, "reference", reference)
    _settings.execution_fields(fields, threads, max_memory)
    if folder is None:
        with tempfile.TemporaryDirectory(prefix="limn-") as work:
            return Comparison(_limn.compare(source_of(scene), fields, work))
    name = _text.path(folder)
    os.makedirs(name, exist_ok=True)
    comparison = Comparison(_limn.compare(source_of(scene), fields, name))
    comparison.write(name)
    return comparison


def _listed_numbers(value: Any) -> str:
    """[1, 2, 3], or "1..3" as the command line has it."""
    return value if isinstance(value, str) else _text.numbers("sweep", value)


def study(
    scene: Any,
    *,
    folder: Optional[Path] = None,
    fresh: bool = False,
    surfaces: Names = None,
    levels: Union[str, Sequence[int], None] = None,
    voxels: Union[str, Sequence[int], None] = None,
    normals: Names = None,
    gradients: Names = None,
    methods: Names = None,
    parameters: Optional[Mapping[str, Any]] = None,
    thresholds: Union[str, Sequence[float], None] = None,
    views: Optional[int] = None,
    flicker: bool = False,
    reference: Optional[str] = None,
    camera: Optional[AnyCamera] = None,
    size: Optional[Tuple[int, int]] = None,
    half_width: Optional[float] = None,
    scheme: Optional[str] = None,
    smooth_angle: Optional[float] = None,
    grids: Names = None,
    threads: Optional[int] = None,
    max_memory: Union[int, str, None] = None,
) -> Study:
    """Sweeps models and resolutions, and measures each border against the true one, as `limn study` does.

    folder: where rows, charts and report.html go; a study of a file or a built-in scene that was stopped goes on there, unless fresh.
    Missing: the rows are in the result alone. levels, voxels, thresholds: lists of numbers, or "0..4". Other settings as for render().
    pandas.DataFrame(study.table) is the table.
    """
    fields: _text.Fields = []
    _settings.surface_fields(fields, surfaces, None, None, half_width, None, None, scheme, None, smooth_angle, grids)
    _settings.camera_fields(fields, camera, size)
    for name, value in (("levels", levels), ("voxels_swept", voxels), ("thresholds", thresholds)):
        _text.add(fields, name, None if value is None else _listed_numbers(value))
    _text.add_all(fields, "normals_swept", _text.listed("normals", normals))
    _text.add_all(fields, "gradients", _text.listed("gradients", gradients))
    _settings.method_fields(fields, methods, parameters, "column")
    _text.add(fields, "views_swept", None if views is None else _text.number(views))
    source = source_of(scene)
    # What a made scene is made of cannot be told again in another process.
    fields += [("flicker", _text.flag(flicker)), ("fresh", _text.flag(fresh if isinstance(source, str) else True))]
    _text.add(fields, "reference", reference)
    _settings.execution_fields(fields, threads, max_memory)
    if folder is None:
        with tempfile.TemporaryDirectory(prefix="limn-") as work:
            return Study(_limn.study(source, fields, work, False), None)
    name = _text.path(folder)
    return Study(_limn.study(source, fields, name, True), name)


def plan(
    scene: Any,
    *,
    tolerance: float,
    metric: str = "border",
    budget: Names = None,
    surfaces: Names = None,
    threshold: Optional[float] = None,
    reference: Optional[str] = None,
    camera: Optional[AnyCamera] = None,
    size: Optional[Tuple[int, int]] = None,
    views: Optional[int] = None,
    scheme: Optional[str] = None,
    smooth_angle: Optional[float] = None,
    grids: Names = None,
    local: bool = False,
    threads: Optional[int] = None,
) -> Plan:
    """Finds the cheapest model whose border is right to a tolerance, as `limn plan` does.

    tolerance: pixels; 95 % of the border lies within. metric: "border" or "silhouette". budget: "64M", "200ms", or both. threshold: N.V
    where the rim's ink ends. local: local models are tried, too. limn.render(scene, **plan.settings) draws from the chosen model.
    """
    fields: _text.Fields = [("tolerance", _text.number(tolerance)), ("metric", str(metric))]
    _text.add_all(fields, "budget", _text.listed("budget", budget))
    _settings.surface_fields(fields, surfaces, scheme=scheme, smooth_angle=smooth_angle, grids=grids)
    _settings.camera_fields(fields, camera, size, None, views)
    if threshold is not None:
        fields.append(("set", f"rim.threshold={_text.number(threshold)}"))
    _text.add(fields, "reference", reference)
    if local:
        fields.append(("local_models", "True"))
    _settings.execution_fields(fields, threads)
    return Plan(json.loads(_limn.plan(source_of(scene), fields)))


def judge(
    drawing: Any,
    against: Any,
    *,
    lines: Names = None,
    threshold: Optional[float] = None,
    crease_angle: Optional[float] = None,
    smooth: bool = False,
    search: Optional[float] = None,
    ink: Any = None,
    alpha: bool = False,
    mask: Optional[Path] = None,
    max_missed: Union[str, float, None] = None,
    max_false: Union[str, float, None] = None,
    max_hidden: Union[str, float, None] = None,
    max_doubled: Union[str, float, None] = None,
    max_displaced: Optional[float] = None,
    camera: Optional[AnyCamera] = None,
    size: Optional[Tuple[int, int]] = None,
    grids: Names = None,
    threads: Optional[int] = None,
) -> Judgement:
    """Measures a drawing against the true lines of a scene, as `limn judge` does.

    drawing: an SVG or a picture's file, or ink as an array (height, width) from 0 to 1. against: what was drawn. ink: the colour of the
    lines; alpha: a picture's alpha is its ink; mask: a picture whose first channel is. Limits: a length in pixels (5) or a share ("1%");
    max_displaced: pixels that 95 % of the matched lines lie within. judgement.passed says whether they hold.
    """
    fields: _text.Fields = []
    _settings.surface_fields(fields, grids=grids)
    _settings.camera_fields(fields, camera, size)
    _settings.line_fields(fields, lines, threshold, crease_angle, smooth)
    limits: Dict[str, Any] = {
        "search": search,
        "max_missed": max_missed,
        "max_false": max_false,
        "max_hidden": max_hidden,
        "max_doubled": max_doubled,
        "max_displaced": max_displaced,
    }
    for name, value in limits.items():
        _text.add(fields, name, None if value is None else value if isinstance(value, str) else _text.number(value))
    _text.add(fields, "ink", None if ink is None else _text.color("ink", ink))
    if alpha is not False:
        fields.append(("alpha", _text.flag(alpha)))
    _text.add(fields, "mask", None if mask is None else _text.path(mask))
    _settings.execution_fields(fields, threads)
    given = _text.path(drawing) if isinstance(drawing, (str, os.PathLike)) else drawing
    return Judgement(_limn.judge(given, source_of(against), fields))


def names(kind: str) -> Dict[str, str]:
    """What there is to choose from, by name, with a line on each. kind: "shapes", "surfaces", "gradients", "methods", "metrics",
    "scenes", "lines", "looks" or "shadings"."""
    return dict(_limn.entries(str(kind)))


def read_channel(file: Path, channel: str) -> "_limn.Array":
    """One channel of a picture's file, top row first: (height, width) float32."""
    return _limn.read_channel(_text.path(file), str(channel))


def channel_names(file: Path) -> List[str]:
    """Channels of a picture's file, in the file's order."""
    return _limn.channel_names(_text.path(file))
