# %% [markdown]
# # The border of my own SDF
#
# A signed distance function of your own, as a formula, as a Python function and as samples: its picture, its lines as vectors, and how
# far each way to model it puts the border from where it is. Every cell runs by itself in this order; `python3 border_of_my_sdf.py` runs
# them all.

# %%
import limn
import numpy

SIZE = (320, 240)  # pixels

# %% [markdown]
# ## As a formula
#
# The function is called once, with symbols; limn records what it does with them. So the field is as quick as a built-in shape, and limn
# can bound it everywhere. numpy's functions work on symbols.


# %%
def drop(x, y, z):
    """A ball that is drawn out upwards; negative inside. World units."""
    return numpy.sqrt(x * x + z * z + numpy.square(y - 0.3 * numpy.sqrt(x * x + z * z + 0.05))) - 0.8


field = limn.formula(drop)
cup = field - limn.shape("sphere", radius=0.5).translate((0, 0.9, 0))
print("bounds of the surface, world units:", field.bounds.round(3).tolist())

# %% [markdown]
# A notebook shows what a cell ends with: the picture, and its lines as SVG.

# %%
picture = limn.render(cup, size=SIZE)
picture

# %%
lines = limn.contours(cup, size=SIZE)
print(lines, [(chain.line_class, chain.qi, len(chain.px)) for chain in lines.visible])
lines

# %% [markdown]
# The layers are numpy arrays that look at the picture's own memory.

# %%
hit = picture.id > 0
print(f"{hit.mean():.1%} of the pixels show the cup, between {picture.depth[hit].min():.3f} and {picture.depth[hit].max():.3f} units away")

# %% [markdown]
# ## As a Python function, and as samples
#
# Any function of arrays x, y and z is drawn, too, such as a trained network, with a bound on its slope (its Lipschitz constant) and a box
# around the surface. limn asks for many points at a time; of one that takes single numbers (without `vectorized`) each value is a call,
# which is slow. Samples on a grid are quick again; what they lose shows in the border.

# %%
called = limn.field(drop, bounds=[(-1.2, -1.2, -1.2), (1.2, 1.5, 1.2)], lipschitz=1.4, vectorized=True)
small = limn.render(field, size=(160, 120), samples=1)
assert (limn.render(called, camera=small.camera, samples=1).id == small.id).all()

axis = numpy.linspace(-1.5, 1.5, 61)
x, y, z = numpy.meshgrid(axis, axis, axis, indexing="ij")
sampled = limn.field_from_grid(drop(x, y, z), origin=(-1.5, -1.5, -1.5), spacing=float(axis[1] - axis[0]))

# %% [markdown]
# ## How far off is each model?
#
# The true border is solved from the formula in double precision. 95 % of a model's border lies within `border_error_p95` pixels of it.

# %%
truth = limn.truth(field, size=SIZE)
print(f"true border: {len(truth.curves)} curves, within {truth.bound_px} px, solved on {truth.source}")
errors = {}
for title, settings in {
    "mesh, level 3": dict(surface="mesh", level=3),
    "level set, 32 voxels": dict(surface="level_set", voxels=32),
    "level set, 64 voxels": dict(surface="level_set", voxels=64),
}.items():
    errors[title] = limn.measure(field, size=SIZE, **settings)["border_error_p95"]
    print(f"{title}: {errors[title]:.3f} px")

# %% [markdown]
# The samples' border is measured against the formula's: two pictures by one camera.

# %%
from_samples = limn.border(sampled, camera=truth.camera, threshold=0)
silhouette = [curve for curve in truth.curves if curve.kind == "silhouette"][0].px
far = max(float(numpy.linalg.norm(silhouette[None] - curve.px[:, None], axis=2).min(axis=1).max()) for curve in from_samples.curves)
print(f"the samples' silhouette: at most {far:.3f} px off")
