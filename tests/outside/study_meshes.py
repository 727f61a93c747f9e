"""Meshes that are no cages, with smooth normals, for studies of what is read from files."""
import numpy as np

# edge_quads fails on its level sets.
OCTAHEDRON = """v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1\ns 1
f 1 3 5\nf 3 2 5\nf 2 4 5\nf 4 1 5\nf 3 1 6\nf 2 3 6\nf 4 2 6\nf 1 4 6\n"""


def ball(halvings):
    """The octahedron with every triangle cut in four so many times, its vertices moved to the unit sphere."""
    lines = [line.split() for line in OCTAHEDRON.splitlines()]
    points = np.array([line[1:] for line in lines if line[0] == "v"], float)
    triangles = points[np.array([line[1:] for line in lines if line[0] == "f"], int) - 1]
    for _ in range(halvings):
        a, b, c = (triangles[:, corner] for corner in range(3))
        ab, bc, ca = (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0
        triangles = np.concatenate([np.stack(corners, axis=1) for corners in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))])
        triangles /= np.linalg.norm(triangles, axis=2, keepdims=True)
    points, corners = np.unique(np.round(triangles.reshape(-1, 3), 9) + 0.0, axis=0, return_inverse=True)
    vertices = "".join("v {:.9f} {:.9f} {:.9f}\n".format(*point) for point in points)
    return vertices + "s 1\n" + "".join("f {} {} {}\n".format(*face) for face in corners.reshape(-1, 3) + 1)
