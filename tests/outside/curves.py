"""The true borders of a surface as curves in the picture: where N.V crosses a value, sought among the surface's parameters."""
import dataclasses

import numpy as np


@dataclasses.dataclass
class Curve:
    px: np.ndarray  # points in order; a closed curve repeats its first point
    outward: np.ndarray  # unit, px, at each point: away from the object (silhouette) or from the ink (inner border)

    def middles(self):
        """The middle of each piece, its outward normal and its length in px."""
        along = np.diff(self.px, axis=0)
        lengths = np.linalg.norm(along, axis=1)
        across = np.stack([-along[:, 1], along[:, 0]], -1) / np.maximum(lengths, 1e-12)[:, None]
        across *= np.sign(np.sum(across * (self.outward[1:] + self.outward[:-1]), -1, keepdims=True))
        return 0.5 * (self.px[1:] + self.px[:-1]), across, lengths


def n_dot_v(surface, camera, u, v):
    points, normals = surface.at(u, v)
    return np.sum(normals * camera.to_eye(points)[0], -1)


def crossings(surface, camera, value):
    """The parameters of the points where edges of a grid of triangles cross N.V = value; and for each kind of edge (right, down, diagonal)
    and cell the number of its point, or -1."""
    nu, nv = surface.grid
    u, v = np.meshgrid(np.arange(nu + 1) / nu, np.arange(nv + 1) / nv, indexing="ij")
    above = n_dot_v(surface, camera, u, v) > value
    numbers, found, count = [], [], 0
    for ends in (((0, 0), (1, 0)), ((0, 0), (0, 1)), ((0, 1), (1, 0))):
        windows = [(slice(a, nu + a), slice(b, nv + b)) for a, b in ends]
        crosses = above[windows[0]] != above[windows[1]]
        number = np.full(crosses.shape, -1)
        number[crosses] = count + np.arange(crosses.sum())
        count += crosses.sum()
        numbers.append(number)
        first, last = (np.stack([u[w][crosses], v[w][crosses]]) for w in windows)
        found.append(bisected(surface, camera, value, first, last, above[windows[0]][crosses]))
    return np.concatenate(found, axis=1), numbers


def bisected(surface, camera, value, a, b, above_a):
    for _ in range(36):
        middle = 0.5 * (a + b)
        same = (n_dot_v(surface, camera, *middle) > value) == above_a
        a, b = np.where(same, middle, a), np.where(same, b, middle)
    return 0.5 * (a + b)


def chains(numbers):
    """Lists of points in order; in closed ones the first comes again at the end."""
    right, down, diagonal = numbers
    triangles = np.concatenate([np.stack([right, down, diagonal], -1).reshape(-1, 3),
                                np.stack([np.roll(down, -1, 0), np.roll(right, -1, 1), diagonal], -1).reshape(-1, 3)])
    triangles = triangles[(triangles >= 0).sum(1) == 2]
    next_to = {}
    for a, b in (t[t >= 0] for t in triangles):
        next_to.setdefault(a, []).append(b)
        next_to.setdefault(b, []).append(a)
    while next_to:
        start = next((p for p, near in next_to.items() if len(near) == 1), next(iter(next_to)))
        chain = [start]
        while next_to.get(chain[-1]):
            at = chain[-1]
            after = next_to[at].pop()
            next_to[after].remove(at)
            if not next_to[at]:
                del next_to[at]
            chain.append(after)
        next_to.pop(chain[-1], None)
        yield np.array(chain)


def visible_runs(chain, visible):
    """Pieces of a chain of which every point is visible."""
    seen = visible[chain]
    if chain[0] == chain[-1] and not seen.all() and seen.any():
        first = int(np.argmin(seen))
        chain = np.concatenate([chain[first:-1], chain[:first + 1]])
        seen = visible[chain]
    changes = np.flatnonzero(np.diff(seen.astype(int))) + 1
    for run in np.split(np.arange(len(chain)), changes):
        if seen[run[0]] and len(run) > 1:
            yield chain[run]


def true_border(surface, camera, value):
    """The visible curves on which N.V = value; 0: the silhouette."""
    (u, v), numbers = crossings(surface, camera, value)
    points, normals = surface.at(u, v)
    ways, distances = camera.to_eye(points)
    px = camera.project(points)
    visible = ~surface.hidden(points, ways, distances)
    outward = camera.outward(normals) if value == 0.0 else rising(surface, camera, u, v)
    return [Curve(px[run], outward[run]) for chain in chains(numbers) for run in visible_runs(chain, visible)]


def rising(surface, camera, u, v, step=1e-5):
    """Unit, px: a direction in the picture along which N.V rises at each point."""
    rise, move = [], []
    for du, dv in ((step, 0.0), (0.0, step)):
        rise.append(n_dot_v(surface, camera, u + du, v + dv) - n_dot_v(surface, camera, u - du, v - dv))
        move.append(camera.project(surface.at(u + du, v + dv)[0]) - camera.project(surface.at(u - du, v - dv)[0]))
    # The gradient of N.V over the picture, by the inverse of the derivative of the picture over the parameters.
    jacobian = np.stack(move, 1)
    gradient = np.linalg.solve(jacobian, np.stack(rise, -1)[..., None])[..., 0]
    return gradient / np.linalg.norm(gradient, axis=-1, keepdims=True)
