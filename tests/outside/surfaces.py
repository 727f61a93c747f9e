"""Three surfaces as scene files for limn and, apart from that, as functions of two parameters with closed forms of their points and normals.
Parameters u and v run from 0 to 1."""
import numpy as np

BEGINS = 1e-3  # world units: what a line to the eye meets nearer to its start is the start itself


def rotation(axis, degrees):
    x, y, z = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


class Surface:
    def note(self):
        """What is not exact about it."""
        return ""


class Torus(Surface):
    name, floor_model, grid, wraps = "torus", {"surface": "analytic"}, (900, 300), (True, True)

    def __init__(self, major, minor, axis, degrees):
        self.major, self.minor, self.axis, self.degrees = major, minor, axis, degrees
        self.turn = rotation(axis, degrees)

    def write_scene(self, folder, camera):
        turn = ", ".join(repr(float(x)) for x in (*self.axis, self.degrees))
        path = folder / "torus.toml"
        sizes = f"major = {self.major!r}\nminor = {self.minor!r}"
        path.write_text(f'{camera.toml()}[[object]]\nshape = "torus"\n{sizes}\nrotate = [{turn}]\n')
        return path

    def at(self, u, v):
        a, b = 2.0 * np.pi * u, 2.0 * np.pi * v
        ring = np.stack([np.cos(a), np.zeros_like(a), np.sin(a)], -1)
        normals = np.cos(b)[..., None] * ring
        normals[..., 1] = np.sin(b)
        return (self.major * ring + self.minor * normals) @ self.turn.T, normals @ self.turn.T

    def hidden(self, points, ways, distances):
        """The quartic of a line that starts on the torus has a root at 0; the other three are those of a cubic."""
        p, d = points @ self.turn, ways @ self.turn
        big, along = self.major ** 2, np.sum(p * d, -1)
        k = np.sum(p * p, -1) + big - self.minor ** 2
        flat_d, flat = d[:, 0] ** 2 + d[:, 2] ** 2, p[:, 0] * d[:, 0] + p[:, 2] * d[:, 2]
        companions = np.zeros((len(p), 3, 3))
        companions[:, 1, 0] = companions[:, 2, 1] = 1.0
        companions[:, 0, 2] = -(4.0 * along * k - 8.0 * big * flat)
        companions[:, 1, 2] = -(4.0 * along ** 2 + 2.0 * k - 4.0 * big * flat_d)
        companions[:, 2, 2] = -4.0 * along
        roots = np.linalg.eigvals(companions)
        met = (np.abs(roots.imag) < 1e-9) & (roots.real > BEGINS) & (roots.real < distances[:, None])
        return met.any(axis=1)


class Ellipsoid(Surface):
    """Its poles (v = 0 and 1), where parameters are of no use, lie towards the eye and away from it: no border comes near."""
    name, floor_model, grid, wraps = "ellipsoid", {"surface": "analytic"}, (900, 300), (True, False)

    def __init__(self, radii, axis, degrees, eye):
        self.radii, self.axis, self.degrees = np.asarray(radii, float), axis, degrees
        self.turn = rotation(axis, degrees)
        pole = unit(np.asarray(eye, float) @ self.turn / self.radii)
        side = unit(np.cross(pole, (0.3, 0.5, 0.8)))
        self.poles = np.stack([side, np.cross(pole, side), pole])

    def write_scene(self, folder, camera):
        path = folder / "ellipsoid.toml"
        radii, turn = (", ".join(repr(float(x)) for x in v) for v in (self.radii, (*self.axis, self.degrees)))
        path.write_text(f'{camera.toml()}[[object]]\nshape = "ellipsoid"\nradii = [{radii}]\nrotate = [{turn}]\n')
        return path

    def at(self, u, v):
        a, b = 2.0 * np.pi * u, np.pi * v
        ball = np.stack([np.sin(b) * np.cos(a), np.sin(b) * np.sin(a), np.cos(b)], -1) @ self.poles
        return (ball * self.radii) @ self.turn.T, unit(ball / self.radii) @ self.turn.T

    def hidden(self, points, ways, distances):
        p, d = points @ self.turn / self.radii, ways @ self.turn / self.radii
        other = -2.0 * np.sum(p * d, -1) / np.sum(d * d, -1)
        return (other > BEGINS) & (other < distances)


def basis(t):
    """The uniform cubic B-spline's four pieces and their slopes at t in [0, 1]."""
    values = np.stack([(1 - t) ** 3, 3 * t ** 3 - 6 * t ** 2 + 4, -3 * t ** 3 + 3 * t ** 2 + 3 * t + 1, t ** 3], -1) / 6.0
    slopes = np.stack([-(1 - t) ** 2, 3 * t ** 2 - 4 * t, -3 * t ** 2 + 2 * t + 1, t ** 2], -1) / 2.0
    return values, slopes


class BicubicRing(Surface):
    """A cage of quads with four at every vertex, closed to a lumpy ring: its Catmull-Clark limit surface is made of uniform bicubic B-spline
    patches and of nothing else. Lines to the eye are held against triangles: that decides only what is hidden, and moves no border."""
    name, grid, wraps = "bicubic", (900, 300), (True, True)
    floor_model = {"surface": "mesh", "level": "6", "normals": "limit"}

    def __init__(self, around, across):
        i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
        a, b = 2.0 * np.pi * i / around, 2.0 * np.pi * j / across
        tube = 0.42 + 0.07 * np.sin(2.0 * a + 0.4) + 0.05 * np.cos(3.0 * a + b)
        out = 1.1 + 0.12 * np.cos(3.0 * a) + tube * np.cos(b)
        self.cage = np.stack([out * np.cos(a), out * np.sin(a), 1.1 * tube * np.sin(b) + 0.15 * np.sin(2.0 * a)], -1)
        self.make_triangles()

    def write_scene(self, folder, camera):
        m, n = self.cage.shape[:2]
        lines = ["v " + " ".join(repr(float(x)) for x in vertex) for vertex in self.cage.reshape(-1, 3)]
        for i in range(m):
            for j in range(n):
                ring = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)]
                lines.append("f " + " ".join(str(a % m * n + b % n + 1) for a, b in ring))
        (folder / "ring.obj").write_text("\n".join(lines) + "\n")
        path = folder / "bicubic.toml"
        path.write_text(f'{camera.toml()}[[object]]\nmesh = "ring.obj"\nscheme = "catmark"\n')
        return path

    def at(self, u, v):
        m, n = self.cage.shape[:2]
        x, y = u * m, v * n
        i, j = np.floor(x).astype(int), np.floor(y).astype(int)
        (bx, sx), (by, sy) = basis(x - i), basis(y - j)
        points, along_u, along_v = (np.zeros((*np.shape(x), 3)) for _ in range(3))
        for k in range(4):
            for l in range(4):
                corner = self.cage[(i + k - 1) % m, (j + l - 1) % n]
                points += (bx[..., k] * by[..., l])[..., None] * corner
                along_u += (sx[..., k] * by[..., l])[..., None] * corner
                along_v += (bx[..., k] * sy[..., l])[..., None] * corner
        return points, unit(np.cross(along_u, along_v))

    def note(self):
        return f"what is hidden is decided by triangles within {self.within:.1e} world units of the surface"

    def make_triangles(self, across=(300, 150)):
        i, j = np.meshgrid(np.arange(across[0]), np.arange(across[1]), indexing="ij")
        points, _ = self.at(i / across[0], j / across[1])
        a, b, c, d = (np.roll(points, (-k, -l), (0, 1)).reshape(-1, 3) for k, l in ((0, 0), (1, 0), (1, 1), (0, 1)))
        middles, _ = self.at((i + 0.5) / across[0], (j + 0.5) / across[1])
        self.within = np.linalg.norm(middles.reshape(-1, 3) - 0.5 * (a + c), axis=-1).max()
        self.triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])

    def hidden(self, points, ways, distances):
        """Tries, for each line, the triangles that lie near it as seen from the eye."""
        eye = points[0] + distances[0] * ways[0]
        toward = unit(-eye)
        side = unit(np.cross(toward, (0.31, 0.52, 0.8)))
        axes = np.stack([side, np.cross(toward, side), toward])
        lines, triangles = ((p - eye) @ axes.T for p in (points, self.triangles))
        line, corner = near_pairs(lines[:, :2] / lines[:, 2:], triangles[..., :2] / triangles[..., 2:])
        a, b, c = (triangles[corner, k] for k in range(3))
        # The depth at which the line meets the triangle's plane, and the volumes that say whether it passes within.
        way = lines[line]
        volumes = np.stack([np.sum(way * np.cross(p, q), -1) for p, q in ((b, c), (c, a), (a, b))])
        within = (volumes >= 0.0).all(axis=0) | (volumes <= 0.0).all(axis=0)
        share = np.sum(a * np.cross(b, c), -1) / volumes.sum(axis=0)
        answers = np.zeros(len(points), bool)
        answers[line[within & ((1.0 - share) * distances[line] > 0.02)]] = True
        return answers


def near_pairs(at, triangles):
    """Indices of points and of triangles in a plane that may hold them: both fall into a grid of cells that no triangle is larger than."""
    cell = np.ptp(triangles, axis=1).max()
    low = triangles.min(axis=(0, 1)) - cell
    place = np.floor((triangles.min(axis=1) - low) / cell).astype(int)
    columns = place[:, 0].max() + 3
    order = np.argsort(place[:, 0] + columns * place[:, 1], kind="stable")
    keys = (place[:, 0] + columns * place[:, 1])[order]
    own = np.floor((at - low) / cell).astype(int)
    pairs = []
    # A triangle's own cell is that of its lower left corner.
    for dx, dy in ((0, 0), (-1, 0), (0, -1), (-1, -1)):
        key = own[:, 0] + dx + columns * (own[:, 1] + dy)
        first, last = np.searchsorted(keys, key, "left"), np.searchsorted(keys, key, "right")
        counts = last - first
        point = np.repeat(np.arange(len(at)), counts)
        pairs.append(np.stack([point, order[np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts) + first[point]]]))
    return np.concatenate(pairs, axis=1)
