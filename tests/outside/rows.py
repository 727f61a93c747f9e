"""A study's rows.csv. Whatever changes about its columns and the names of its values changes here alone."""
import csv
import dataclasses

# Columns of a model's settings. A method's parameters have a column each, METHOD.PARAMETER.
SETTINGS = ("voxels", "voxel_size", "half_width", "gradient", "level", "scheme", "normals", "smooth_angle", "local")
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
    time_low_ms: float
    time_high_ms: float
    parts_ms: tuple  # building, tracing and the border together: the median, the least, the largest
    bytes: int
    failed: str
    truth: str  # where the true border is from; empty where there is none
    truth_exact: bool
    truth_bound_px: float
    threshold: float  # of the true border
    values: dict = dataclasses.field(default_factory=dict)  # name in rows.csv -> number
    floors: dict = dataclasses.field(default_factory=dict)  # what the reference itself scores, where that is known
    units: dict = dataclasses.field(default_factory=dict)

    def value(self, name):
        return self.values[name_in(self.values, name)]


def name_in(names, name):
    """What the rows with these names call a value that is known here as `name`."""
    for known in METRICS[name]:
        if known in names:
            return known
    raise KeyError(f"rows.csv has no value {' or '.join(METRICS[name])}")


def number(text):
    return float(text) if text else float("nan")


def cell_of(row):
    settings = {"surface": row["surface"], **{name: row[name] for name in SETTINGS if row[name]}}
    prefix = row["method"] + "."
    parameters = {name[len(prefix):]: text for name, text in row.items() if text and name.startswith(prefix)}
    parts = tuple(number(row[f"build{kind}_ms"]) + number(row[f"trace{kind}_ms"]) + number(row["border_ms"]) for kind in ("", "_low", "_high"))
    return Cell(row["key"], int(row["view"]), settings, row["method"], parameters, number(row["resolution"]), number(row["time_ms"]),
                number(row["time_low_ms"]), number(row["time_high_ms"]), parts, int(row["bytes"] or 0), row["failed"], row["truth"],
                row["truth_exact"] == "true", number(row["truth_bound_px"]), number(row["threshold"]))


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
                if row["floor"]:
                    cells[row["key"]].floors[row["metric"]] = number(row["floor"])
    return list(cells.values())
