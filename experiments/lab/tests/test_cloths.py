"""The pictures of the experiment cloths: frames, the cloth, and BRDFs along paths."""
import unittest

import numpy

from lab.tests import FolderTest, load
from renderer import scene


def paths(directions):
    """Paths of light to a small sphere under the small sky."""
    options = scene.parser("").parse_args(["--size=16x16"])
    options.positions, options.lights, options.directions = 4, 64, directions
    return load("renderer", "light_paths").paths(options)


class FramesTest(unittest.TestCase):
    def test_x_runs_along_the_parallels_of_the_sphere_to_the_right(self):
        sphere = load("renderer", "light_paths").Sphere()
        rays = numpy.array([[0.0, 0.0, -1.0], [0.02, 0.03, -1.0], [0.5, 0.0, -1.0]])
        rays /= numpy.linalg.norm(rays, axis=1)[:, None]
        hit, frames, points = sphere.hits(numpy.array([0.0, 0.0, 20.0]), rays)
        self.assertEqual(hit.tolist(), [True, True, False])
        numpy.testing.assert_allclose(frames[0], numpy.eye(3), atol=1e-12)
        x, y, n = frames[1]
        numpy.testing.assert_allclose(n, points[1])
        numpy.testing.assert_allclose(frames[1] @ frames[1].T, numpy.eye(3), atol=1e-12)
        self.assertAlmostEqual(x[1], 0)
        self.assertGreater(x[0], 0.8)
        numpy.testing.assert_allclose(y, numpy.cross(n, x))

    def test_directions_have_the_half_angles_of_the_bins(self):
        bins, local = paths(directions=False), paths(directions=True)
        numpy.testing.assert_array_equal(bins["light"], local["light"])
        lit = (bins["light"] > 0).any(axis=-1)
        wi = local["wi"][lit].astype(float)
        wo = local["wo"][numpy.nonzero(lit)[0]].astype(float)
        found = scene.coordinates(numpy.array([0.0, 0.0, 1.0]), wi, wo)
        expected = bins["at"][lit] / numpy.array(bins["steps"]) - 0.5
        numpy.testing.assert_allclose(found[:, :2], expected[:, :2], atol=0.01)


class ClothTest(FolderTest):
    def test_the_warp_lies_in_the_cloth_and_keeps_its_length_on_top(self):
        drape = load("cloths", "drape")
        u, v = numpy.random.default_rng(1).uniform(-1, 1, (2, 200))
        step = 1e-4
        warp = (drape.points(u + step, v) - drape.points(u - step, v)) / (2 * step)
        normals = drape.normals(u, v)
        numpy.testing.assert_allclose((warp * normals).sum(axis=1), 0, atol=1e-3)
        self.assertGreater(normals[numpy.hypot(u, v) < 0.4, 1].min(), 0.7)
        near = numpy.hypot(u, v) < 0.1
        numpy.testing.assert_allclose(numpy.linalg.norm(warp[near], axis=1), 1, atol=0.02)


class RenderTest(unittest.TestCase):
    def test_matt_light_is_counted_and_azimuths_are_the_frame_s(self):
        render = load("cloths", "render").render
        along = paths(directions=True)

        def matt(pairs):
            return numpy.full((len(pairs), 3), 0.5 / numpy.pi)

        def of_light_from(sign):
            return lambda pairs: numpy.maximum(sign * pairs[:, 0, 1:2], 0) * numpy.ones(3)
        found, share = render(along, {"matt": matt, "from y": of_light_from(1),
                                      "from -y": of_light_from(-1)}, 75)
        inner, whole = found["matt"]
        lit = numpy.zeros((256, 3))
        numpy.add.at(lit, along["pixel"],
                     along["light"].astype(float).sum(axis=1) * along["unit"])
        numpy.testing.assert_allclose(whole.reshape(-1, 3), lit * 0.5 / numpy.pi, rtol=1e-6)
        self.assertEqual(share[0, 0], -1)
        self.assertTrue((inner <= whole + 1e-12).all())
        # In the middle 75 degrees leave out little; matt light is lost in this share.
        self.assertGreater(share[8, 8], 0.85)
        self.assertLess(share[8, 8], 1)
        numpy.testing.assert_allclose(inner[8, 8].sum(), share[8, 8] * whole[8, 8].sum())
        # The sky is bright above, where y leads on the lower half of the sphere.
        self.assertGreater(found["from y"][1][13, 8, 0], 2 * found["from -y"][1][13, 8, 0])


if __name__ == "__main__":
    unittest.main()
