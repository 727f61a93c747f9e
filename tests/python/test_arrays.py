"""Meshes and level sets from and to arrays."""

import gc
import unittest

import limn
import numpy
from limn_test import TestCase, random_numbers

CUBE = numpy.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
FACES = numpy.array([[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]])


def cube(**more):
    return limn.Mesh(CUBE, [4] * 6, FACES.reshape(-1), **more)


class Meshes(TestCase):
    def test_arrays_come_back(self):
        mesh = cube()
        numpy.testing.assert_array_equal(mesh.positions, CUBE)
        numpy.testing.assert_array_equal(mesh.face_sizes, [4] * 6)
        numpy.testing.assert_array_equal(mesh.corner_vertices, FACES.reshape(-1))
        self.assertEqual((mesh.positions.dtype, mesh.face_sizes.dtype), (numpy.float64, numpy.int32))
        self.assertIsNone(mesh.vertex_colors)
        numpy.testing.assert_array_equal(mesh.bounds, [[-1] * 3, [1] * 3])

    def test_arrays_out_look_at_the_mesh_and_outlive_it(self):
        mesh = cube()
        positions = mesh.positions
        self.assertEqual(positions.__array_interface__["data"][0], mesh.positions.__array_interface__["data"][0])
        with self.assertRaises(ValueError):
            positions[0, 0] = 5
        del mesh
        gc.collect()
        numpy.testing.assert_array_equal(positions, CUBE)

    def test_arrays_in_are_copied(self):
        given = CUBE.copy()
        mesh = limn.Mesh(given, [4] * 6, FACES.reshape(-1))
        given[:] = 9
        numpy.testing.assert_array_equal(mesh.positions, CUBE)

    def test_any_layout_of_memory_and_type_is_read_right(self):
        wide = numpy.zeros((16, 6), dtype=numpy.float32)
        wide[::2, ::2] = CUBE
        for positions in (wide[::2, ::2], numpy.asfortranarray(CUBE), CUBE.astype(">f8"), CUBE.astype(int), CUBE.tolist(), CUBE[::-1][::-1]):
            numpy.testing.assert_array_equal(limn.Mesh(positions, [4] * 6, FACES.reshape(-1)).positions, CUBE)
        for kind in (numpy.int64, numpy.uint8, ">i2"):
            mesh = limn.Mesh(CUBE, numpy.full(6, 4, kind), FACES.reshape(-1).astype(kind))
            numpy.testing.assert_array_equal(mesh.corner_vertices, FACES.reshape(-1))

    def test_bad_arrays_are_refused(self):
        nan = CUBE.copy()
        nan[3, 1] = numpy.nan
        for positions in (nan, CUBE[:, :2], CUBE.reshape(-1), CUBE + 0j, "CUBE", None, [[1, 2], [3]], CUBE[:7], CUBE.astype(object), []):
            with self.assertRaises(limn.InputError, msg=repr(positions)):
                limn.Mesh(positions, [4] * 6, FACES.reshape(-1))
        for sizes, corners in (
            ([4] * 5, FACES.reshape(-1)),
            ([2] * 12, FACES.reshape(-1)),
            ([4.0] * 6, FACES.reshape(-1)),
            ([-4] * 6, FACES.reshape(-1)),
            ([2**40] * 6, FACES.reshape(-1)),
            ([2**31 - 1] * 6, FACES.reshape(-1)),
            ([4] * 6, FACES.reshape(-1) + 1),
            ([4] * 6, FACES.reshape(-1) - 1),
            ([4] * 6, FACES),
            ([4] * 6, FACES.reshape(-1) * 1.0),
            ([], []),
        ):
            with self.assertRaises(limn.InputError, msg=repr((sizes, corners))):
                limn.Mesh(CUBE, sizes, corners)
        for more in (dict(vertex_colors=CUBE[:3]), dict(creases=[[0, 9]], sharpness=[1]), dict(creases=[[0, 1]], sharpness=[-1]),
                     dict(creases=[[0, 1]]), dict(creases=[[0, 1]], sharpness=[1, 2]), dict(creases=[[0, 1]], sharpness=[numpy.nan])):
            with self.assertRaises(limn.InputError, msg=repr(more)):
                cube(**more)

    def test_triangles_and_colours(self):
        mesh = limn.mesh_from_triangles(CUBE[[0, 1, 2, 4]], [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], vertex_colors=numpy.full((4, 3), 0.25))
        numpy.testing.assert_array_equal(mesh.vertex_colors, numpy.full((4, 3), 0.25))
        self.assertEqual(mesh.vertex_colors.dtype, numpy.float32)
        with self.assertRaises(limn.InputError):
            limn.mesh_from_triangles(CUBE, FACES)

    def test_files_hold_the_same(self):
        cube().write(self.file("cube.ply"))
        mesh = limn.read_mesh(self.file("cube.ply"))
        numpy.testing.assert_array_equal(mesh.positions, CUBE)
        with self.assertRaisesRegex(limn.InputError, "no such file"):
            limn.read_mesh(self.file("none.ply"))

    def test_subdivision_goes_to_a_known_limit(self):
        # The limit of a vertex of valence n is (n^2 V + 4 sum(edge neighbours) + sum(face neighbours)) / (n (n + 5)): half a cube's corner.
        refined = cube().refine(1)
        numpy.testing.assert_allclose(numpy.abs(refined.positions[:8]), 0.5 * numpy.ones((8, 3)), atol=1e-6)
        sharp = cube(creases=[[a, b] for face in FACES for a, b in zip(face, numpy.roll(face, -1))], sharpness=[10] * 24).refine(2)
        numpy.testing.assert_allclose(sharp.bounds, [[-1] * 3, [1] * 3], atol=1e-6)
        for level in (-1, 9):
            with self.assertRaises(limn.InputError):
                cube().refine(level)
        with self.assertRaises(limn.InputError):
            cube().refine(1, scheme="doo")

    def test_a_tessellation_lies_on_its_field(self):
        ball = limn.shape("sphere", radius=2)
        self.assertLess(float(numpy.abs(ball.values(limn.tessellate(ball, 2).positions)).max()), 1e-9)


def ball_samples(count, reach, dtype=float):
    axis = numpy.linspace(-reach, reach, count)
    x, y, z = numpy.meshgrid(axis, axis, axis, indexing="ij")
    return (numpy.sqrt(x * x + y * y + z * z) - 1).astype(dtype), float(axis[1] - axis[0])


class LevelSets(TestCase):
    def test_a_dense_array_goes_there_and_back(self):
        values, size = ball_samples(30, 1.5)
        made = limn.level_set_from_array(values, voxel_size=size, origin=(-1.5, -1.5, -1.5))
        back, origin = limn.level_set_to_array(made, margin=2)
        first = numpy.rint((origin + 1.5) / size).astype(int)
        near = numpy.abs(values) < 3 * size
        part = tuple(slice(max(0, f), f + n) for f, n in zip(first, back.shape))
        clipped = back[tuple(slice(max(0, -f), None) for f in first)][tuple(slice(0, 30) for _ in range(3))]
        expected, mask = values[part].astype("f4"), near[part]
        clipped = clipped[tuple(slice(0, n) for n in expected.shape)]
        numpy.testing.assert_array_equal(clipped[mask], expected[mask])
        numpy.testing.assert_array_equal(numpy.sign(clipped[~mask]), numpy.sign(expected[~mask]))
        numpy.testing.assert_allclose(numpy.abs(clipped[~mask]), 3 * size, rtol=1e-6)
        self.assertEqual(made.active_voxel_count, int(near.sum()))

    def test_sparse_voxels_go_there_and_back(self):
        values, size = ball_samples(30, 1.5)
        near = numpy.argwhere(numpy.abs(values) < 3 * size)
        order = random_numbers().permutation(len(near))
        indices, given = near[order] - 40, values[tuple(near[order].T)]
        made = limn.level_set_from_voxels(indices, given, voxel_size=size, origin=(7, 8, 9), half_width=3)
        back, numbers = made.active()
        a, b = numpy.lexsort(indices.T), numpy.lexsort(back.T)
        numpy.testing.assert_array_equal(indices[a], back[b])
        numpy.testing.assert_array_equal(given[a].astype("f4"), numbers[b])
        numpy.testing.assert_allclose(made.values((numpy.array([7, 8, 9]) + size * indices[:50])), given[:50], atol=1e-6)

    def test_both_draw_the_same(self):
        values, size = ball_samples(40, 1.5)
        near = numpy.argwhere(numpy.abs(values) < 3 * size)
        dense = limn.level_set_from_array(values, voxel_size=size, origin=(-1.5,) * 3)
        sparse = limn.level_set_from_voxels(near, values[tuple(near.T)], voxel_size=size, origin=(-1.5,) * 3, half_width=3)
        camera = limn.Camera(eye=(0, 0, 5), target=(0, 0, 0), ortho=3, size=(100, 100))
        a, b = limn.render(dense, camera=camera), limn.render(sparse, camera=camera)
        for layer in ("depth", "normal", "border"):
            self.assertSameBits(getattr(a, layer), getattr(b, layer))
        self.assertAlmostEqual(a.hits * (3 / 100) ** 2, numpy.pi, delta=0.05)

    def test_fields_and_meshes_become_level_sets(self):
        ball = limn.shape("sphere", radius=1)
        for source in (ball, limn.tessellate(ball, 4)):
            made = limn.level_set(source, voxels=40)
            indices, values = made.active()
            world = made.world_from_index
            at = indices @ world[:3, :3].T + world[:3, 3]
            numpy.testing.assert_allclose(values, numpy.linalg.norm(at, axis=1) - 1, atol=2e-3)
        with self.assertRaises(limn.InputError):
            limn.level_set(ball, voxels=40, voxel_size=0.1)
        with self.assertRaises(limn.InputError):
            limn.level_set("ball")

    def test_files_hold_the_same(self):
        made = limn.level_set(limn.shape("torus"), voxels=32)
        made.write(self.file("torus.vdb"))
        back = limn.read_level_set(self.file("torus.vdb"))
        for a, b in zip(made.active(), back.active()):
            self.assertSameBits(a, b)

    def test_the_surface_can_be_meshed(self):
        mesh = limn.level_set(limn.shape("sphere", radius=1), voxels=40).mesh()
        self.assertLess(float(numpy.abs(numpy.linalg.norm(mesh.positions, axis=1) - 1).max()), 0.01)

    def test_bad_arrays_are_refused(self):
        values, size = ball_samples(16, 1.5)
        nan = values.copy()
        nan[0, 0, 0] = numpy.nan
        for wrong in (nan, values[0], values + 0j, None, "x", numpy.ones((4, 4, 4)), -values, numpy.zeros((0, 3, 3)), values * numpy.inf):
            with self.assertRaises(limn.InputError, msg=repr(wrong)[:80]):
                limn.level_set_from_array(wrong, voxel_size=size)
        for more in (dict(voxel_size=0), dict(voxel_size=-1), dict(voxel_size=numpy.nan), dict(voxel_size="x"), dict(half_width=1),
                     dict(half_width=numpy.inf), dict(origin=(0, 0)), dict(origin=(0, 0, numpy.inf))):
            with self.assertRaises(limn.InputError, msg=repr(more)):
                limn.level_set_from_array(values, **{"voxel_size": size, **more})
        for indices, numbers in (([[0, 0, 0]], [1, 2]), ([[0.5, 0, 0]], [1]), ([[0, 0]], [1]), ([[2**40, 0, 0]], [1]), ([[2**30, 0, 0]], [1]),
                                 ([[0, 0, 0]], [numpy.nan]), (numpy.zeros((0, 3), int), []), ([], []), (None, None)):
            with self.assertRaises(limn.InputError, msg=repr((indices, numbers))):
                limn.level_set_from_voxels(indices, numbers, voxel_size=0.1)


class OpenVDB(TestCase):
    def setUp(self):
        super().setUp()
        try:
            import pyopenvdb
        except ImportError:
            self.skipTest("no pyopenvdb; the package python3-openvdb brings it")
        self.openvdb = pyopenvdb

    def test_a_grid_of_pyopenvdb_is_drawn(self):
        grid = self.openvdb.createLevelSetSphere(radius=1.0, voxelSize=0.05)
        made = limn.level_set_from_openvdb(grid)
        indices, values = made.active()
        self.assertEqual(len(indices), grid.activeVoxelCount())
        accessor = grid.getConstAccessor()
        for index, value in zip(indices[::97].tolist(), values[::97]):
            self.assertEqual(accessor.getValue(tuple(index)), value)
        drawn = limn.render(made, camera=limn.Camera(eye=(0, 0, 5), target=(0, 0, 0), ortho=3, size=(100, 100)))
        self.assertAlmostEqual(drawn.hits * (3 / 100) ** 2, numpy.pi, delta=0.05)

    def test_a_level_set_becomes_a_grid_of_pyopenvdb(self):
        made = limn.level_set(limn.shape("torus"), voxels=32)
        grid = limn.level_set_to_openvdb(made)
        indices, values = made.active()
        self.assertEqual(grid.activeVoxelCount(), len(indices))
        accessor = grid.getConstAccessor()
        for index, value in zip(indices[::53].tolist(), values[::53]):
            self.assertEqual(accessor.getValue(tuple(index)), value)

    def test_what_is_no_grid_is_refused(self):
        with self.assertRaises(limn.InputError):
            limn.level_set_from_openvdb(3)
        with self.assertRaises(limn.InputError):
            limn.level_set_from_openvdb(self.openvdb.FloatGrid())


if __name__ == "__main__":
    unittest.main()
