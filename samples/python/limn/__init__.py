"""limn draws the border of implicit surfaces and measures how far that border can be trusted.

    import limn

    egg = limn.formula(lambda x, y, z: (x * x + y * y + z * z).sqrt() + 0.2 * y - 1, bounds=[(-2, -2, -2), (2, 2, 2)])
    picture = limn.render(egg | limn.shape("torus", major=1.5), size=(640, 480), surface="level_set", voxels=128)
    lines = limn.contours(egg)          # a notebook shows both
    picture.normal                      # numpy arrays, without copies

What is drawn (the argument ``scene``) is a file (scene file, mesh, volume, formula), the name of a built-in scene, a Scene, a Model, a
Field, a Mesh, a LevelSet, or a list of these. Settings have the names of the command line's options: ``limn.render("teacup",
voxels=64)`` is ``limn render teacup --voxels 64``. Lengths are in world units unless a name ends in ``_px`` or ``_voxels``; angles are
degrees; colours are linear. Pixels have their origin top left, their centres at +0.5.

A call lets go of the interpreter's lock while limn works, and Ctrl-C stops it. InputError (a ValueError) is raised for what a caller
can cause, MachineError (a RuntimeError) where the machine fails.
"""

from ._limn import (
    Border,
    Chain,
    Curve,
    Field,
    InputError,
    MachineError,
    Model,
    ResolvedCamera,
    Scene,
    __version__,
)
from ._calls import (
    border,
    channel_names,
    compare,
    contours,
    judge,
    measure,
    model,
    names,
    plan,
    read_channel,
    render,
    study,
    truth,
)
from ._fields import field, field_from_grid, formula, shape
from ._level_sets import (
    level_set,
    level_set_from_array,
    level_set_from_openvdb,
    level_set_from_voxels,
    level_set_to_array,
    level_set_to_openvdb,
    read_level_set,
)
from ._limn import LevelSet, Mesh, Picture
from ._meshes import mesh_from_triangles, read_mesh, tessellate
from ._results import Comparison, Judgement, Lines, Measures, Plan, Study
from ._scenes import Object, load, scene
from ._settings import Camera

__all__ = [
    "Border",
    "Camera",
    "Chain",
    "Comparison",
    "Curve",
    "Field",
    "InputError",
    "Judgement",
    "LevelSet",
    "Lines",
    "MachineError",
    "Measures",
    "Mesh",
    "Model",
    "Object",
    "Picture",
    "Plan",
    "ResolvedCamera",
    "Scene",
    "Study",
    "__version__",
    "border",
    "channel_names",
    "compare",
    "contours",
    "field",
    "field_from_grid",
    "formula",
    "judge",
    "level_set",
    "level_set_from_array",
    "level_set_from_openvdb",
    "level_set_from_voxels",
    "level_set_to_array",
    "level_set_to_openvdb",
    "load",
    "measure",
    "mesh_from_triangles",
    "model",
    "names",
    "plan",
    "read_channel",
    "read_level_set",
    "read_mesh",
    "render",
    "scene",
    "shape",
    "study",
    "tessellate",
    "truth",
]
