# %% [markdown]
# # Which voxel size do I need?
#
# A level set's border is as right as its voxels are small. This notebook measures how right, as a table that pandas takes, and asks limn
# for the coarsest level set that will do. `python3 which_voxel_size.py` runs every cell.

# %%
import limn

SCENE = "tilted_torus"
SIZE = (320, 240)  # pixels
TOLERANCE = 0.5  # pixels that 95 % of the border may lie off

# %% [markdown]
# ## The table
#
# A study builds each model, draws it and measures its border against the true one.

# %%
study = limn.study(SCENE, size=SIZE, surfaces="level_set", voxels=[16, 32, 64, 128], gradients=["central", "cubic"], views=2)
print(study.summary)

# %% [markdown]
# `study.table` is a dict of columns: `pandas.DataFrame(study.table)`. Without pandas the columns are lists.

# %%
try:
    import pandas

    table = pandas.DataFrame(study.table)
    errors = table[table.metric == "border_error_p95"].pivot_table(index="voxels", columns="gradient", values="value", aggfunc="max")
    print("95 % of the border within, px, in the worst view:")
    print(errors.round(3))
    worst = {(gradient, int(voxels)): value for gradient, column in errors.items() for voxels, value in column.items()}
except ImportError:
    worst = {}
    columns = study.table
    for metric, gradient, voxels, value in zip(columns["metric"], columns["gradient"], columns["voxels"], columns["value"]):
        if metric == "border_error_p95" and voxels == voxels:
            key = (gradient, int(voxels))
            worst[key] = max(worst.get(key, 0.0), value)
    for (gradient, voxels), value in sorted(worst.items()):
        print(f"{gradient}, {voxels} voxels: {value:.3f} px")

# %% [markdown]
# Twice the voxels, about a quarter of the error:

# %%
assert worst[("cubic", 128)] < worst[("cubic", 32)] / 4

# %% [markdown]
# ## The answer
#
# A plan searches for the coarsest level set that keeps to the tolerance, and measures it.

# %%
plan = limn.plan(SCENE, tolerance=TOLERANCE, surfaces="level_set", size=SIZE)
for sentence in plan.summary:
    print(sentence)
print("settings:", plan.settings)

# %% [markdown]
# What the plan chose is what to draw with.

# %%
measured = limn.measure(SCENE, size=SIZE, **plan.settings)
print(f"95 % of the border within {measured['border_error_p95']:.3f} px, all of it within {measured['border_error_max']:.3f} px")
assert measured["border_error_p95"] <= TOLERANCE
picture = limn.render(SCENE, size=SIZE, samples=4, **plan.settings)
picture
