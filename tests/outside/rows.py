"""A study's rows.csv. Whatever changes about its columns and the names of its values changes here alone."""
import csv
import dataclasses

# Columns of a model's settings; older files have them as one text, "level=2;normals=limit".
SETTINGS = ("voxels", "voxel_size", "half_width", "gradient", "level", "normals", "scheme")
SETTING_TEXTS = ("surface_parameters",)
# What this folder calls a value -> the names it has had in rows.
METRICS = {f"{kind}_{what}": (f"{kind}_displacement_{what}",) for kind in ("silhouette", "inner") for what in ("mean", "rms", "p95")}


@dataclasses.dataclass
class Model:
    settings: dict  # "surface" and what it was made with, as texts
    view: int
    values: dict  # name in rows.csv -> number

    def value(self, name):
        for known in METRICS[name]:
            if known in self.values:
                return self.values[known]
        raise KeyError(f"rows.csv has no value {' or '.join(METRICS[name])}")


def settings_of(row):
    settings = {"surface": row["surface"]}
    for column in SETTING_TEXTS:
        settings.update(part.split("=", 1) for part in (row.get(column) or "").split(";") if part)
    settings.update({name: row[name] for name in SETTINGS if row.get(name)})
    return settings


def read_models(path):
    """A model for each cell of the study, in the order of the rows."""
    models = {}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row.get("failed"):
                raise ValueError(f"{path}: a cell failed: {row['failed']}")
            model = models.setdefault(row["key"], Model(settings_of(row), int(row["view"]), {}))
            if row["metric"]:
                model.values[row["metric"]] = float(row["value"]) if row["value"] else float("nan")
    return list(models.values())
