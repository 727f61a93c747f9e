"""How far the border in a picture lies from a true border, along the true one's outward normal: positive where the object, or the ink, has
grown. Pictures are FACTOR times as large as the picture whose pixels displacements are counted in."""
import dataclasses

import numpy as np

FACTOR = 2
REACH_PX = 5.0
STEP_PX = 0.1


@dataclasses.dataclass
class Displacements:
    values: np.ndarray  # px
    lengths: np.ndarray  # px of border that each stands for
    missing: float  # share of the true border where the picture has none

    def mean(self):
        return np.average(self.values, weights=self.lengths)

    def rms(self):
        return np.sqrt(np.average(self.values ** 2, weights=self.lengths))

    def p95(self):
        order = np.argsort(np.abs(self.values))
        share = np.cumsum(self.lengths[order]) / self.lengths.sum()
        return np.abs(self.values)[order][np.searchsorted(share, 0.95)]


def bilinear(picture, px):
    """Between pixel centres; no number beside a pixel without one, and beyond the picture."""
    x, y = px[..., 0] * FACTOR - 0.5, px[..., 1] * FACTOR - 0.5
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    inside = (i >= 0) & (j >= 0) & (i + 1 < picture.shape[1]) & (j + 1 < picture.shape[0])
    i, j = np.where(inside, i, 0), np.where(inside, j, 0)
    a, b = x - i, y - j
    value = (1 - b) * ((1 - a) * picture[j, i] + a * picture[j, i + 1]) + b * ((1 - a) * picture[j + 1, i] + a * picture[j + 1, i + 1])
    return np.where(inside, value, np.nan)


def inner(curves, pictures, threshold):
    """Along each normal, the nearest place where N.V rises through the threshold. Its square is what is taken as linear between pixel
    centres: before a silhouette it grows as the distance, and N.V itself as the distance's root."""
    middles, outward, lengths = (np.concatenate(part) for part in zip(*(curve.middles() for curve in curves)))
    seen = np.where(pictures["id.Y"] > 0, pictures["NdotV.Y"] ** 2, np.nan)
    along = np.arange(-REACH_PX, REACH_PX + 0.5 * STEP_PX, STEP_PX)
    excess = bilinear(seen, middles[:, None] + along[:, None] * outward[:, None]) - threshold ** 2
    before, after = excess[:, :-1], excess[:, 1:]
    with np.errstate(invalid="ignore", divide="ignore"):
        places = np.where((before < 0.0) & (after >= 0.0), along[:-1] + STEP_PX * before / (before - after), np.inf)
    nearest = places[np.arange(len(places)), np.argmin(np.abs(places), axis=1)]
    found = np.isfinite(nearest)
    return Displacements(nearest[found], lengths[found], 1.0 - lengths[found].sum() / lengths.sum())


def flat_pieces(curve, axis):
    """Stretches of the curve that run along an axis of the picture rather than across it, always the same way."""
    steps = np.diff(curve.px, axis=0)
    forward = np.where(np.abs(steps[:, axis]) > 0.5 * np.abs(steps[:, 1 - axis]), np.sign(steps[:, axis]), 0)
    for piece in np.split(np.arange(len(steps)), np.flatnonzero(np.diff(forward)) + 1):
        if forward[piece[0]]:
            points = curve.px[np.append(piece, piece[-1] + 1)]
            outward = curve.outward[piece[len(piece) // 2]]
            yield (points if forward[piece[0]] > 0 else points[::-1]), outward


def heights(points, axis):
    """Of the columns of pixels that the piece crosses: their numbers, the curve's mean height in each, and its rise from side to side."""
    along, height = points[:, axis], points[:, 1 - axis]
    columns = np.arange(np.ceil(along[0]), np.floor(along[-1]))
    below = np.concatenate([[0.0], np.cumsum(np.diff(along) * 0.5 * (height[1:] + height[:-1]))])
    sides = np.append(columns, columns[-1] + 1) if len(columns) else np.zeros(1)
    # The integral of the height is a parabola between two points; its own height there makes it exact.
    k = np.clip(np.searchsorted(along, sides, side="right") - 1, 0, len(along) - 2)
    at_side = np.interp(sides, along, height)
    area = below[k] + (sides - along[k]) * 0.5 * (height[k] + at_side)
    return columns.astype(int), np.diff(area), np.diff(at_side)


def silhouette(curves, pictures):
    """How much more of each column of pixels is covered than lies behind the true curve. A pixel's coverage is a share of its area, so
    that the sum over a column is right to a fraction of a pixel."""
    values, lengths, crossed = [], [], 0.0
    for axis in (0, 1):
        covered = pictures["A"] if axis == 0 else pictures["A"].T
        for curve in curves:
            for points, outward in flat_pieces(curve, axis):
                columns, height, rise = heights(points, axis)
                for column, h, slope in zip(columns, height, rise):
                    # Steeper ones belong to the other axis.
                    if abs(slope) > 1.0:
                        continue
                    length = np.hypot(1.0, slope)
                    crossed += length
                    value = column_displacement(covered, column, h, np.sign(outward[1 - axis]))
                    if value is not None:
                        values.append(value / length)
                        lengths.append(length)
    return Displacements(np.array(values), np.array(lengths), 1.0 - sum(lengths) / crossed)


def column_displacement(covered, column, height, outward):
    """None where the window about the curve does not lead from the object to the background."""
    first, last = (int(round(FACTOR * (height + way * REACH_PX))) for way in (-1, 1))
    if first < 0 or last > len(covered):
        return None
    window = covered[first:last, FACTOR * column:FACTOR * (column + 1)].mean(axis=1)
    ends = (window[0], window[-1])
    if ends != ((1.0, 0.0) if outward > 0 else (0.0, 1.0)):
        return None
    inside = height - first / FACTOR if outward > 0 else last / FACTOR - height
    return window.sum() / FACTOR - inside
