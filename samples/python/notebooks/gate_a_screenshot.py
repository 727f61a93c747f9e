# %% [markdown]
# # Gate a toon shader's screenshot
#
# A toon shader draws outlines on the GPU. Its screenshot is held against the true lines of the same scene and camera: what it misses,
# what it draws where no line is, and how far off the rest lies. Beyond a limit a pipeline fails. Here numpy plays the shader: it inks the
# pixels where depth or normals jump. `python3 gate_a_screenshot.py` runs every cell.

# %%
import limn
import numpy

SIZE = (480, 360)  # pixels
part = limn.shape("box", half=(0.9, 0.35, 0.6)) - limn.shape("cylinder", radius=0.3, half_height=1).translate((0.4, 0, 0))
camera = limn.Camera(eye=(2.1, 2.3, 3.2), target=(0, 0, 0), size=SIZE)

# %% [markdown]
# ## The shader
#
# It sees what a G-buffer holds: depth and normals at the pixel centres.


# %%
def toon_outlines(depth, normal, depth_step, normal_step):
    """Ink from 0 to 1, (height, width): a line a pixel wide where a neighbour to the right or below differs."""
    z = numpy.where(numpy.isfinite(depth), depth, 1e3)
    ink = numpy.zeros(z.shape, dtype=bool)
    for axis in (0, 1):
        jump = numpy.abs(numpy.diff(z, axis=axis)) > depth_step
        bend = numpy.linalg.norm(numpy.diff(normal, axis=axis), axis=2) > normal_step
        part_of = (slice(None, -1), slice(None)) if axis == 0 else (slice(None), slice(None, -1))
        ink[part_of] |= jump | bend
    return ink.astype(numpy.float32)


seen = limn.render(part, camera=camera)
screenshot = toon_outlines(seen.depth, seen.normal, depth_step=0.1, normal_step=0.5)

# %% [markdown]
# ## The gate
#
# `judge` takes the ink as an array, or a screenshot's file (`limn.judge("shot.png", ...)`, with `ink="#101010"` for the lines' colour).

# %%
LIMITS = dict(max_missed="5%", max_false="5%", max_displaced=1.5)
judgement = limn.judge(screenshot, part, camera=camera, **LIMITS)
print(judgement.text)
assert judgement.passed

# %% [markdown]
# A shader whose threshold for normals is too high loses the creases. The gate says so, and where.

# %%
careless = toon_outlines(seen.depth, seen.normal, depth_step=0.1, normal_step=3.0)
failed = limn.judge(careless, part, camera=camera, **LIMITS)
print(failed.text)
assert not failed.passed

# %% [markdown]
# In a pipeline: the JUnit file tells the server, the page shows the drawing over the lines and its worst places enlarged.

# %%
report, page = failed.junit(), failed.report()
print(f"{report.count('<failure')} limit exceeded of {report.count('<testcase')}; a page of {len(page):,} characters")
