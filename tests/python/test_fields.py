"""Fields: known values, CSG as minima and maxima, formulas and callables against each other."""

import math
import unittest

import limn
import numpy
from limn_test import TestCase, random_numbers


def points(count=500, reach=2.0):
    return random_numbers().uniform(-reach, reach, (count, 3))


class Shapes(TestCase):
    def test_values_have_closed_forms(self):
        at = points()
        ball = limn.shape("sphere", radius=0.75)
        numpy.testing.assert_allclose(ball.values(at), numpy.linalg.norm(at, axis=1) - 0.75, atol=1e-13)
        ring = limn.shape("torus", major=1.0, minor=0.25)
        expected = numpy.hypot(numpy.hypot(at[:, 0], at[:, 2]) - 1.0, at[:, 1]) - 0.25
        numpy.testing.assert_allclose(ring.values(at), expected, atol=1e-13)
        numpy.testing.assert_allclose(ball.gradients(at), at / numpy.linalg.norm(at, axis=1)[:, None], atol=1e-12)

    def test_bounds_hold_the_surface_tightly(self):
        numpy.testing.assert_allclose(limn.shape("ellipsoid", radii=(1, 2, 3)).bounds, [[-1, -2, -3], [1, 2, 3]], atol=1e-9)

    def test_every_shape_can_be_made(self):
        for name in limn.names("shapes"):
            self.assertTrue(numpy.isfinite(limn.shape(name).values(points(10))).all(), name)

    def test_operators_are_minima_and_maxima(self):
        at = points()
        a, b = limn.shape("sphere", radius=1), limn.shape("box", half=(0.5, 1.5, 0.7)).translate((0.3, 0, 0))
        va, vb = a.values(at), b.values(at)
        numpy.testing.assert_array_equal((a | b).values(at), numpy.minimum(va, vb))
        numpy.testing.assert_array_equal((a & b).values(at), numpy.maximum(va, vb))
        numpy.testing.assert_array_equal((a - b).values(at), numpy.maximum(va, -vb))
        smooth = a.union(b, smooth=0.3).values(at)
        self.assertTrue((smooth <= numpy.minimum(va, vb) + 1e-15).all())
        self.assertLess(float((smooth - numpy.minimum(va, vb)).min()), -0.01)
        far = numpy.abs(va - vb) > 0.6 + 1e-9
        numpy.testing.assert_allclose(smooth[far], numpy.minimum(va, vb)[far], atol=1e-15)
        with self.assertRaises(TypeError):
            a | 3

    def test_transforms_move_points(self):
        at = points()
        shape = limn.shape("box", half=(0.2, 0.5, 0.9))
        numpy.testing.assert_allclose(shape.translate((1, 2, 3)).values(at), shape.values(at - [1, 2, 3]), atol=1e-12)
        numpy.testing.assert_allclose(shape.scale(2).values(at), 2 * shape.values(at / 2), atol=1e-12)
        turned = numpy.stack([at[:, 2], at[:, 1], -at[:, 0]], axis=1)  # back by 90 degrees about -y is forth about y
        numpy.testing.assert_allclose(shape.rotate((0, 1, 0), -90).values(at), shape.values(turned @ numpy.diag([-1, 1, -1])), atol=1e-12)
        numpy.testing.assert_allclose(shape.offset(0.1).values(at), shape.values(at) - 0.1, atol=1e-15)
        numpy.testing.assert_allclose(shape.shell(0.2).values(at), numpy.abs(shape.values(at)) - 0.1, atol=1e-15)


class Formulas(TestCase):
    def test_a_formula_is_a_multiple_of_its_function(self):
        def egg(x, y, z):
            return numpy.sqrt(x * x + y**2 + numpy.square(z)) + 0.2 * y - numpy.cos(x) / 3 - 0.5 + abs(z) * 0.1 - numpy.minimum(x, 1) * 0

        at = points()
        made = limn.formula(egg)
        values, expected = made.values(at), egg(*at.T)
        factor = float(values @ expected / (expected @ expected))
        self.assertGreater(factor, 0)
        # Not as ratios: near the surface both are differences that cancel, and rounding alone is 1e-12 of what is left.
        numpy.testing.assert_allclose(values / factor, expected, rtol=0, atol=1e-13)
        slopes = numpy.linalg.norm(made.gradients(at), axis=1)
        self.assertLessEqual(float(slopes.max()), made.lipschitz * (1 + 1e-9))

    def test_bounds_cut_what_has_no_end(self):
        with self.assertRaisesRegex(limn.InputError, "bounded surface"):
            limn.formula(lambda x, y, z: x * x + y * y - 1)
        cut = limn.formula(lambda x, y, z: x * x + y * y - 1, bounds=[(-2, -2, -1), (2, 2, 1)])
        self.assertTrue(numpy.isfinite(cut.bounds).all())
        self.assertGreater(cut.values([[0, 0, 1.5]])[0], 0)
        self.assertLess(cut.values([[0, 0, 0.5]])[0], 0)

    def test_what_is_no_formula_is_refused(self):
        for function in (
            lambda x, y, z: x if x > 0 else y,
            lambda x, y, z: math.sin(x),
            lambda x, y, z: "x",
            lambda x, y, z: None,
            lambda x, y, z: numpy.floor(x),
            lambda x, y, z: x**-1,
            lambda x, y, z: x * float("nan"),
            3,
        ):
            with self.assertRaises(limn.InputError):
                limn.formula(function)
        with self.assertRaises(ZeroDivisionError):
            limn.formula(lambda x, y, z: x / (1 // 0))


class Callables(TestCase):
    BALL = dict(bounds=[(-1.1,) * 3, (1.1,) * 3], lipschitz=1.0)

    @staticmethod
    def ball(x, y, z):
        return math.sqrt(x * x + y * y + z * z) - 1

    def test_it_is_drawn_as_the_shape_is(self):
        field = limn.field(self.ball, **self.BALL)
        at = points(50)
        numpy.testing.assert_allclose(field.values(at), limn.shape("sphere", radius=1).values(at), atol=1e-14)
        camera = limn.Camera(eye=(0, 0, 4), target=(0, 0, 0), size=(24, 18))
        drawn, expected = (limn.render(one, camera=camera, samples=1) for one in (field, limn.shape("sphere", radius=1)))
        numpy.testing.assert_array_equal(drawn.id, expected.id)
        hit = expected.id > 0
        numpy.testing.assert_allclose(drawn.depth[hit], expected.depth[hit], atol=1e-4)
        numpy.testing.assert_allclose(drawn.normal[hit], expected.normal[hit], atol=1e-3)

    def test_a_gradient_may_be_given(self):
        field = limn.field(self.ball, gradient=lambda x, y, z: (7, 8, 9), **self.BALL)
        numpy.testing.assert_array_equal(field.gradients([[0.5, 0, 0]]), [[7, 8, 9]])

    def test_what_it_raises_comes_out(self):
        def raises(x, y, z):
            raise LookupError("no such value")

        with self.assertRaisesRegex(LookupError, "no such value"):
            limn.field(raises, **self.BALL).values([[0, 0, 0]])
        with self.assertRaisesRegex(LookupError, "no such value"):
            limn.render(limn.field(raises, **self.BALL), size=(16, 12))
        with self.assertRaisesRegex(LookupError, "no such value"):
            limn.level_set(limn.field(raises, **self.BALL), voxels=16)

    def test_what_it_returns_is_checked(self):
        for wrong in (None, "1", [1, 2], object(), float("nan"), float("inf"), 1j):
            with self.assertRaises(limn.InputError, msg=repr(wrong)):
                limn.field(lambda x, y, z: wrong, **self.BALL).values([[0, 0, 0]])
            with self.assertRaises(limn.InputError, msg=repr(wrong)):
                limn.render(limn.field(lambda x, y, z: wrong, **self.BALL), size=(16, 12))
        self.assertEqual(limn.field(lambda x, y, z: numpy.float32(2), **self.BALL).values([[0, 0, 0]])[0], 2.0)

    def test_what_it_needs_is_checked(self):
        for wrong in (dict(lipschitz=0), dict(lipschitz=-1), dict(lipschitz=float("nan")), dict(lipschitz="1"), dict(bounds=[(0, 0, 0)] * 3),
                      dict(bounds=[(1, 1, 1), (0, 0, 0)]), dict(bounds=[(0, 0, 0), (1, 1, float("inf"))]), dict(bounds=None)):
            with self.assertRaises(limn.InputError, msg=repr(wrong)):
                limn.field(self.ball, **{**self.BALL, **wrong})
        with self.assertRaises(limn.InputError):
            limn.field(3, **self.BALL)


class Arrays(TestCase):
    """Functions that take arrays."""

    BALL = dict(bounds=[(-1.1,) * 3, (1.1,) * 3], lipschitz=1.0, vectorized=True)

    def setUp(self):
        self.calls, self.asked = 0, 0

    def ball(self, x, y, z):
        self.calls += 1
        self.asked += len(x)
        return numpy.sqrt(x * x + y * y + z * z) - 1

    def test_pictures_and_level_sets_are_those_of_single_points(self):
        field, single = limn.field(self.ball, **self.BALL), limn.field(Callables.ball, **Callables.BALL)
        at = points(300)
        numpy.testing.assert_array_equal(field.values(at), single.values(at))
        numpy.testing.assert_array_equal(field.gradients(at), single.gradients(at))
        camera = limn.Camera(eye=(0, 0, 4), target=(0, 0, 0), size=(24, 18))
        drawn, expected = (limn.render(one, camera=camera, samples=1) for one in (field, single))
        numpy.testing.assert_array_equal(drawn.depth, expected.depth)
        numpy.testing.assert_array_equal(drawn.normal, expected.normal)
        grids = [limn.level_set(one, voxels=16).active() for one in (field, single)]
        numpy.testing.assert_array_equal(grids[0][0], grids[1][0])
        numpy.testing.assert_array_equal(grids[0][1], grids[1][1])

    def test_many_points_are_asked_for_at_once(self):
        field = limn.field(self.ball, **self.BALL)
        limn.render(field, size=(48, 36))
        self.assertGreater(self.asked, 10 * self.calls)
        self.setUp()
        limn.level_set(field, voxels=32)
        self.assertGreater(self.asked, 50 * self.calls)

    def test_columns_and_gradients(self):
        field = limn.field(lambda x, y, z: self.ball(x, y, z)[:, None], gradient=lambda x, y, z: numpy.stack([x, 2 * y, 3 * z], 1), **self.BALL)
        at = points(20)
        numpy.testing.assert_allclose(field.values(at), numpy.linalg.norm(at, axis=1) - 1, atol=1e-14)
        numpy.testing.assert_array_equal(field.gradients(at), at * [1, 2, 3])
        numpy.testing.assert_array_equal(limn.field(lambda x, y, z: (x + 2).astype(numpy.float32), **self.BALL).values([[0, 0, 0]]), [2.0])

    def test_what_it_returns_is_checked(self):
        wrong = {
            "None": lambda x, y, z: None,
            "text": lambda x, y, z: ["a"] * len(x),
            "one number": lambda x, y, z: numpy.float64(2),
            "too many": lambda x, y, z: numpy.zeros(len(x) + 1),
            "NaN": lambda x, y, z: numpy.where(x > -9, numpy.nan, 0),
            "infinity": lambda x, y, z: numpy.full(len(x), numpy.inf),
        }
        for name, function in wrong.items():
            with self.assertRaisesRegex(limn.InputError, "function", msg=name):
                limn.field(function, **self.BALL).values(points(3))
            with self.assertRaisesRegex(limn.InputError, "function", msg=name):
                limn.render(limn.field(function, **self.BALL), size=(16, 12))
        with self.assertRaisesRegex(limn.InputError, r"gradient.*\(3, 3\)"):
            limn.field(self.ball, gradient=lambda x, y, z: x, **self.BALL).gradients(points(3))
        with self.assertRaisesRegex(limn.InputError, "vectorized"):
            limn.field(self.ball, **{**self.BALL, "vectorized": 1})

    def test_what_it_raises_comes_out(self):
        def raises(x, y, z):
            raise LookupError("no such value")

        with self.assertRaisesRegex(LookupError, "no such value"):
            limn.render(limn.field(raises, **self.BALL), size=(16, 12))


class Grids(TestCase):
    @staticmethod
    def samples(count=24, reach=1.3):
        axis = numpy.linspace(-reach, reach, count)
        x, y, z = numpy.meshgrid(axis, axis, axis, indexing="ij")
        return numpy.sqrt(x * x + y * y * 1.44 + z * z) - 1, axis

    def test_values_are_trilinear(self):
        values, axis = self.samples()
        spacing = float(axis[1] - axis[0])
        field = limn.field_from_grid(values, origin=(axis[0],) * 3, spacing=spacing)
        at = random_numbers().integers(0, len(axis), (200, 3))
        nodes = axis[0] + spacing * at
        numpy.testing.assert_allclose(field.values(nodes), values.astype("f4")[tuple(at.T)], atol=1e-6)
        middles = nodes[:, None, :].repeat(1, 1)[:, 0] + spacing * numpy.array([0.5, 0, 0])
        inner = at[:, 0] + 1 < len(axis)
        expected = (values.astype("f4")[tuple(at[inner].T)] + values.astype("f4")[tuple((at[inner] + [1, 0, 0]).T)]) / 2
        numpy.testing.assert_allclose(field.values(middles[inner]), expected, atol=1e-6)

    def test_the_slope_bound_holds(self):
        rng = random_numbers()
        noise = numpy.pad(rng.uniform(-1, 1, (5, 5, 5)), 1, constant_values=1.0)
        field = limn.field_from_grid(noise, origin=(0, 0, 0), spacing=0.5)
        a, b = rng.uniform(-1, 4, (2, 4000, 3))
        slopes = numpy.abs(field.values(a) - field.values(b)) / numpy.linalg.norm(a - b, axis=1)
        self.assertLessEqual(float(slopes.max()), field.lipschitz)
        self.assertLessEqual(float(numpy.linalg.norm(field.gradients(a), axis=1).max()), field.lipschitz * (1 + 1e-12))

    def test_it_is_drawn(self):
        values, axis = self.samples()
        field = limn.field_from_grid(values, origin=(axis[0],) * 3, spacing=float(axis[1] - axis[0]))
        drawn = limn.render(field, camera=limn.Camera(eye=(0, 0, 9), target=(0, 0, 0), ortho=3, size=(90, 90)))
        area = drawn.hits * (3 / 90) ** 2
        self.assertAlmostEqual(area, math.pi / 1.2, delta=0.06)

    def test_a_surface_that_is_cut_is_refused(self):
        values, axis = self.samples(reach=0.9)
        with self.assertRaisesRegex(limn.InputError, "reaches the grid's faces"):
            limn.field_from_grid(values, origin=(0, 0, 0), spacing=0.1)


if __name__ == "__main__":
    unittest.main()
