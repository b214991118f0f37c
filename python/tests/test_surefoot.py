"""What the module says, against closed forms. Run it where the wheel is installed: `python -m unittest discover python/tests`."""

import math
import pathlib
import unittest

import numpy as np
import surefoot

EXAMPLES = pathlib.Path(__file__).resolve().parents[2] / "examples"
BALL = 'param size = 1 in 0.2..2 "radius"\nparam at = (0, 0, 0) in -1..1\nscene = sphere(size).translate(at)\n'


class Test(unittest.TestCase):
    def test_field_and_bound(self):
        points = np.random.default_rng(1).uniform(-2, 2, (1000, 3))
        scene = surefoot.compile(BALL)
        distance = np.linalg.norm(points, axis=1)
        np.testing.assert_allclose(scene.field(points), distance - 1, atol=1e-12)
        np.testing.assert_allclose(scene.field(points, size=0.5), distance - 0.5, atol=1e-12)
        moved = np.linalg.norm(points - [0.5, 0, -0.25], axis=1)
        np.testing.assert_allclose(scene.field(points, at=(0.5, 0, -0.25)), moved - 1, atol=1e-12)
        twisted = surefoot.compile("scene = box(1).twist(y, 2)")
        # A step of the bound crosses no surface.
        bound, field = twisted.bound(points), twisted.field(points)
        way = np.random.default_rng(2).normal(size=(1000, 3))
        way /= np.linalg.norm(way, axis=1)[:, None]
        outside = field > 0
        self.assertTrue(outside.sum() > 500)
        self.assertTrue((twisted.field(points + way * (0.999 * np.maximum(bound, 0))[:, None])[outside] > 0).all())

    def test_parameters_and_errors(self):
        scene = surefoot.compile(BALL)
        self.assertEqual(scene.parameters["size"]["default"], [1.0])
        self.assertEqual(scene.parameters["size"]["description"], "radius")
        with self.assertRaisesRegex(KeyError, "no parameter sice; it has size, at"):
            scene.field(np.zeros((1, 3)), sice=1)
        with self.assertRaisesRegex(ValueError, "outside of 0.2 to 2"):
            scene.field(np.zeros((1, 3)), size=3)
        with self.assertRaisesRegex(ValueError, "3 columns"):
            scene.field(np.zeros((1, 2)))
        with self.assertRaisesRegex(surefoot.Error, "sphear"):
            surefoot.compile("scene = sphear(1)")
        [found] = surefoot.check("scene = sphear(1)")
        self.assertEqual((found["severity"], found["line"], found["column"]), ("error", 1, 9))
        self.assertEqual(surefoot.check(BALL), [])
        with self.assertRaises(ValueError):
            surefoot.compile()

    def test_module_and_bounds(self):
        scene = surefoot.compile("scene = sphere(1)")
        self.assertIn("fn sf_field(p: vec3f) -> f32", scene.wgsl)
        np.testing.assert_allclose(scene.bounds, [[-1, -1, -1], [1, 1, 1]], atol=0.1)
        self.assertIsNone(surefoot.compile("scene = plane(y)").bounds)

    def test_mesh(self):
        vertices, triangles = surefoot.compile(BALL).mesh(64, size=0.5)
        self.assertEqual((vertices.shape[1], triangles.shape[1]), (3, 3))
        a, b, c = (vertices[triangles[:, i]] for i in range(3))
        volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6
        self.assertAlmostEqual(volume, 4 / 3 * math.pi * 0.5**3, delta=2e-3)
        with self.assertRaisesRegex(surefoot.Error, "no end"):
            surefoot.compile("scene = plane(y)").mesh()

    def test_picture(self):
        scene = surefoot.compile(path=str(EXAMPLES / "csg.sdf"))
        pixels = scene.render(96, 64, samples=1)
        self.assertEqual((pixels.shape, pixels.dtype), ((64, 96, 4), np.uint8))
        self.assertTrue((pixels[..., 3] == 255).all())
        # Something is drawn, and it changes with the time.
        self.assertGreater(pixels[..., :3].std(), 10)
        later = scene.render(96, 64, samples=1, time=2.0)
        self.assertGreater(np.abs(later.astype(int) - pixels.astype(int)).mean(), 1)


if __name__ == "__main__":
    unittest.main()
