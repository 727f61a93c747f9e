"""The numbers of a study's charts, from its cells: medians and quartiles over the views, what beats what, orders of convergence."""
import dataclasses
import math

import numpy as np

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
    bytes: int

    def __post_init__(self):
        self.series = study_names.series_of(self.settings)
        self.is_choice = self.settings["surface"] != "analytic"
        self.quantiles = [quantile(self.errors, share) for share in SHARES]
        self.median = self.quantiles[2]

    def cost(self, kind):
        return self.time_ms if kind == "time" else self.bytes


class Study:
    def __init__(self, cells, titles):
        """`titles`: the models, in the page's order."""
        self.all_cells, self.titles = cells, titles
        self.drawings = study_names.drawings_of(cells)
        self.title = {cell.key: study_names.title_of(cell.settings) for cell in cells}
        self.cells = [cell for cell in cells if not cell.failed]
        self.settings, self.resolutions = {}, {}
        for cell in cells:
            title = self.title[cell.key]
            self.settings[title] = cell.settings
            if not math.isfinite(self.resolutions.get(title, np.nan)):
                self.resolutions[title] = cell.resolution

    def unit(self, metric):
        return next((cell.units[metric] for cell in self.cells if metric in cell.units), "")

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
        return Point(title, self.settings[title], self.resolutions[title], [error for error, _, _ in group],
                     [view for _, view, _ in group], quantile(sorted(cell.time_ms for cell in cells), 0.5), max(cell.bytes for cell in cells))


def beaten_by(points, kind):
    """For each point those that beat it: no dearer and no worse, and of two equal ones the first. The analytic surface is no choice."""
    costs, errors = np.array([(point.cost(kind), point.median) for point in points]).reshape(-1, 2).T
    choice, place = np.array([point.is_choice for point in points], bool), np.arange(len(points))
    no_dearer, no_worse = costs[None] <= costs[:, None], errors[None] <= errors[:, None]
    equal = (costs[None] == costs[:, None]) & (errors[None] == errors[:, None])
    beats = no_dearer & no_worse & (~equal | (place[None] < place[:, None])) & choice[None] & choice[:, None]
    return [[points[k] for k in np.flatnonzero(row)] for row in beats]


def front(points, kind):
    """What nothing beats, cheapest first."""
    return sorted((point for point, better in zip(points, beaten_by(points, kind)) if point.is_choice and not better),
                  key=lambda point: point.cost(kind))


def cheapest_within(points, tolerance, kind):
    good = [point for point in points if point.is_choice and point.median <= tolerance]
    return min(good, key=lambda point: (point.cost(kind), point.time_ms), default=None)


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
