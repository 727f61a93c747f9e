"""A study's rows.csv. Whatever changes about its columns and the names of its values changes here alone."""
import csv
import dataclasses

# Columns of a model's settings; older files have all of them as one text, "level=2;normals=limit".
SETTINGS = ("voxels", "voxel_size", "half_width", "gradient", "level", "normals", "scheme")
SETTINGS_TEXT, METHOD_TEXT = "surface_parameters", "method_parameters"
# What every file has; other columns are parameters of methods.
CELL_COLUMNS = ("key", "scene", "view", "surface", SETTINGS_TEXT, "method", METHOD_TEXT, "metric", "value", "unit", "resolution", "time_ms",
                "build_ms", "trace_ms", "border_ms", "bytes", "failed")
# What this folder calls a value -> the names it has had in rows.
METRICS = {f"{kind}_{what}": (f"{kind}_displacement_{what}",) for kind in ("silhouette", "inner") for what in ("mean", "rms", "p95")}


@dataclasses.dataclass
class Cell:
    """One model in one view, drawn by one method."""
    key: str
    view: int
    settings: dict  # "surface" and what the model was made with, as texts
    method: str
    parameters: dict  # of the method, as texts
    resolution: float
    time_ms: float
    bytes: int
    failed: str
    values: dict = dataclasses.field(default_factory=dict)  # name in rows.csv -> number
    units: dict = dataclasses.field(default_factory=dict)

    def value(self, name):
        return self.values[name_in(self.values, name)]


def name_in(names, name):
    """What the rows with these names call a value that is known here as `name`."""
    for known in METRICS[name]:
        if known in names:
            return known
    raise KeyError(f"rows.csv has no value {' or '.join(METRICS[name])}")


def parts_of(text):
    return dict(part.split("=", 1) for part in (text or "").split(";") if part)


def number(text):
    return float(text) if text else float("nan")


def cell_of(row):
    settings = {"surface": row["surface"], **parts_of(row.get(SETTINGS_TEXT)), **{name: row[name] for name in SETTINGS if row.get(name)}}
    others = {name: text for name, text in row.items() if text and name not in CELL_COLUMNS and name not in SETTINGS}
    return Cell(row["key"], int(row["view"]), settings, row["method"], {**parts_of(row.get(METHOD_TEXT)), **others}, number(row["resolution"]),
                number(row["time_ms"]), int(row["bytes"] or 0), row.get("failed") or "")


def read_cells(path):
    """In the order of the rows, those that failed too."""
    cells = {}
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["key"] not in cells:
                cells[row["key"]] = cell_of(row)
            if row["metric"]:
                cells[row["key"]].values[row["metric"]] = number(row["value"])
                cells[row["key"]].units[row["metric"]] = row["unit"]
    return list(cells.values())
