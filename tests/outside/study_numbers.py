"""The numbers of a study's charts, from its cells: medians and quartiles over the views, what beats what, orders of convergence."""
import dataclasses
import math

import numpy as np

import rows
import study_floor
import study_names


SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)


def quantile(ascending, share):
    """Between the two values about the place share * (n - 1), linearly."""
    at = share * (len(ascending) - 1)
    below = int(at)
    above = min(below + 1, len(ascending) - 1)
    return ascending[below] + (at - below) * (ascending[above] - ascending[below])


@dataclasses.dataclass
class Point:
    """One model under one drawing, over its views."""
    title: str
    settings: dict
    resolution: float
    errors: list  # ascending
    views: list  # in the order of the errors
    time_ms: float
    low_ms: float
    high_ms: float
    bytes: int

    def __post_init__(self):
        self.series = study_names.series_of(self.settings)
        self.is_analytic = self.settings["surface"] == "analytic"
        self.quantiles = [quantile(self.errors, share) for share in SHARES]
        self.median = self.quantiles[2]

    def cost(self, kind):
        return self.time_ms if kind == "time" else self.bytes


class Study:
    def __init__(self, cells, titles, record):
        """`titles`: the models, in the page's order; `record`: study.json."""
        self.all_cells, self.titles, self.record = cells, titles, record
        self.drawings = study_names.drawings_of(cells)
        self.title = {cell.key: study_names.title_of(cell.settings) for cell in cells}
        self.cells = [cell for cell in cells if not cell.failed]
        self.settings, self.resolutions = {}, {}
        for cell in cells:
            title = self.title[cell.key]
            self.settings[title] = cell.settings
            if not math.isfinite(self.resolutions.get(title, np.nan)):
                self.resolutions[title] = cell.resolution

        self.units = {name: unit for cell in cells for name, unit in cell.units.items() if not study_names.is_position(name)}

    def unit(self, metric):
        return self.units.get(metric, "")

    def named(self, name):
        """What the rows call a value that is known as `name` (rows.METRICS), or None."""
        return next((known for known in rows.METRICS[name] if known in self.units), None)

    def floor(self, metric):
        return study_floor.floor_of(self.all_cells, self.record, metric)

    def fit_floor(self, metric):
        """What is not above it is left out of fits; what the reference scores is no part of it."""
        return dataclasses.replace(self.floor(metric), reference_px=0.0).px if self.unit(metric) == "px" else 0.0

    def cells_of(self, drawing, view=None):
        return [cell for cell in self.cells if self.drawings[cell.key] == drawing and view in (None, cell.view)]

    def points(self, drawing, metric, view=None):
        """Of the models with at least one finite value, in the page's order."""
        groups = {title: [] for title in self.titles}
        for cell in self.cells_of(drawing, view):
            value = abs(cell.values.get(metric, np.nan))
            if math.isfinite(value):
                groups[self.title[cell.key]].append((value, cell.view, cell))
        return [self.point(title, sorted(group, key=lambda one: one[:2])) for title, group in groups.items() if group]

    def point(self, title, group):
        cells = [cell for _, _, cell in group]
        times = (quantile(sorted(getattr(cell, name) for cell in cells), 0.5) for name in ("time_ms", "time_low_ms", "time_high_ms"))
        return Point(title, self.settings[title], self.resolutions[title], [error for error, _, _ in group],
                     [view for _, view, _ in group], *times, max(cell.bytes for cell in cells))


def beaten_by(points, kind):
    """For each point those that beat it: no dearer and no worse, and of two equal ones the first."""
    costs, errors = np.array([(point.cost(kind), point.median) for point in points]).reshape(-1, 2).T
    place = np.arange(len(points))
    no_dearer, no_worse = costs[None] <= costs[:, None], errors[None] <= errors[:, None]
    equal = (costs[None] == costs[:, None]) & (errors[None] == errors[:, None])
    beats = no_dearer & no_worse & (~equal | (place[None] < place[:, None]))
    return [[points[k] for k in np.flatnonzero(row)] for row in beats]


def front(points, kind):
    """What nothing beats, cheapest first."""
    return sorted((point for point, better in zip(points, beaten_by(points, kind)) if not better), key=lambda point: point.cost(kind))


def smallest_of(points):
    return min(points, key=lambda point: (point.bytes, point.time_ms), default=None)


def may_be_quickest(points):
    """Those that may be as quick as the quickest, by the spread of their times."""
    quickest = min(points, key=lambda point: point.time_ms, default=None)
    return [point for point in points if point is quickest or point.low_ms <= quickest.high_ms]


def order_fit(points, floor):
    """(order, factor, finest, coarsest) of error = factor * resolution^order by least squares of logarithms, or None."""
    good = [(point.resolution, point.median) for point in points if point.resolution > 0.0 and point.median > floor]
    if len(good) < 3:
        return None
    x, y = np.log(np.array(good).T)
    if np.sum((x - x.mean()) ** 2) < 1e-6:
        return None
    order, at_zero = np.polyfit(x, y, 1)
    return float(order), float(np.exp(at_zero)), float(np.exp(x.min())), float(np.exp(x.max()))


def views_shown(points, most=16):
    """The models whose views have a line each: the fronts and every series' finest, best first."""
    finest = {point.series: point for point in points}
    chosen = []
    for point in front(points, "time") + list(finest.values()) + front(points, "memory"):
        if len(chosen) < most and all(point is not other for other in chosen):
            chosen.append(point)
    place = {id(point): i for i, point in enumerate(points)}
    return sorted(chosen, key=lambda point: (point.median, place[id(point)]))
