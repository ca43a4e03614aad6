"""The pictures of the experiment appearance: paths of light, tables, and how pictures compare."""
import unittest

import numpy

from lab import merl
from lab.tests import FolderTest, load
from renderer import pictures, scene


class PathsTest(FolderTest):
    def test_coordinates_of_the_centres_are_their_numbers(self):
        of = [a[::7, ::5, ::11].ravel() for a in merl.angles()]
        theta_h, theta_d, phi_d = of
        # The difference vector, turned so that z goes to h.
        x, y, z = (numpy.sin(theta_d) * numpy.cos(phi_d), numpy.sin(theta_d) * numpy.sin(phi_d),
                   numpy.cos(theta_d))

        def turned(x, y, z):
            return numpy.stack([x * numpy.cos(theta_h) + z * numpy.sin(theta_h), y,
                                z * numpy.cos(theta_h) - x * numpy.sin(theta_h)], axis=-1)
        wi, wo = turned(x, y, z), turned(-x, -y, z)
        # Another frame, so that nothing hangs on z or x.
        turn = numpy.linalg.qr(numpy.random.default_rng(1).normal(size=(3, 3)))[0]
        turn *= numpy.linalg.det(turn)
        found = scene.coordinates(turn @ [0, 0, 1], wi @ turn.T, wo @ turn.T)
        expected = numpy.stack(numpy.meshgrid(*(numpy.arange(n)[::step] for n, step in zip(
            merl.SHAPE, (7, 5, 11))), indexing="ij"), axis=-1).reshape(-1, 3)
        numpy.testing.assert_allclose(found, expected, atol=1e-6)

    def test_an_even_sky_lights_all_normals_alike(self):
        paths = load("renderer", "light_paths")
        n = numpy.random.default_rng(2).normal(size=(50, 3))
        n /= numpy.linalg.norm(n, axis=1)[:, None]
        wo = n + 0.8 * numpy.roll(n, 1, axis=1)
        wo /= numpy.linalg.norm(wo, axis=1)[:, None]
        even = numpy.concatenate([paths._even(0, round(share * 4096)) for share in paths.SHARES])
        _, light = paths.draw(paths.Environment(numpy.ones((64, 128, 3))), n, wo,
                              numpy.broadcast_to(even, (50, 4096, 2)))
        lit = (wo * n).sum(axis=1) > 0
        self.assertGreater(lit.sum(), 20)
        numpy.testing.assert_allclose(light.sum(axis=1)[lit], numpy.pi, rtol=0.01)

    def test_draws_meet_what_is_bright(self):
        paths = load("renderer", "light_paths")
        environment = paths.Environment(paths.sky())
        directions = environment.draw(*paths._even(0, 20000).T)
        radiance, density = environment.radiance_and_density(directions)
        theta = (numpy.arange(1000) + 0.5) / 1000 * numpy.pi
        phi = (numpy.arange(2000) + 0.5) / 1000 * numpy.pi
        t, p = numpy.meshgrid(theta, phi, indexing="ij")
        grid = numpy.stack([numpy.sin(t) * numpy.cos(p), numpy.cos(t),
                            numpy.sin(t) * numpy.sin(p)], axis=-1)
        exact, of_grid = environment.radiance_and_density(grid)
        cell = (numpy.sin(t) * (numpy.pi / 1000) ** 2)
        numpy.testing.assert_allclose((of_grid * cell).sum(), 1, rtol=1e-3)
        numpy.testing.assert_allclose((radiance / density[:, None]).mean(axis=0),
                                      (exact * cell[..., None]).sum(axis=(0, 1)), rtol=5e-3)

    def test_a_direction_that_is_too_long_by_rounding_is_one_all_the_same(self):
        paths = load("renderer", "light_paths")
        up = numpy.array([[0.0, 1 + 1e-12, 0.0]])
        for of in paths.Environment(paths.sky()).radiance_and_density(up):
            self.assertTrue(numpy.isfinite(of).all() and (of > 0).all())


class TablesTest(FolderTest):
    def test_a_table_is_read_as_it_was_written(self):
        table = numpy.random.default_rng(3).random((*merl.SHAPE, 3))
        table[3, 4, 5] = -1
        table[3, 4, 6, 1] = numpy.nan
        merl.write(self.folder / "x.binary", table)
        found = merl.read(self.folder / "x.binary")
        self.assertTrue((found[3, 4, 5:7] < 0).all())
        found[3, 4, 5:7] = table[3, 4, 5:7]
        numpy.testing.assert_allclose(found, table, rtol=1e-14)
        (self.folder / "y").write_bytes(b"abc")
        with self.assertRaisesRegex(ValueError, "not in MERL layout"):
            merl.read(self.folder / "y")

    def test_rows_leave_out_what_was_not_measured_and_go_on_below_the_surface(self):
        above = numpy.minimum(*merl.cosines()) > 0
        measured = numpy.where(above, numpy.arange(180), -1.0)[..., None] * numpy.ones(3)
        measured[20, 30] = -1
        rows = load("appearance", "bins.py").rows(measured, [numpy.full((*merl.SHAPE, 3), 7.0)])
        rows = rows.reshape(*merl.SHAPE, 7)
        self.assertEqual(rows[20, 30].max(), 0)
        self.assertFalse(above[60, 60, 0])
        first = numpy.flatnonzero(above[60, 60])[0]
        numpy.testing.assert_array_equal(rows[60, 60, 0], [first] * 3 + [7] * 3 + [1])
        numpy.testing.assert_array_equal(rows[10, 10, 50], [50] * 3 + [7] * 3 + [1])

    def test_bivariate_is_exact_where_phi_does_not_matter_and_else_a_mean(self):
        bivariate = load("appearance", "bivariate").bivariate
        table = numpy.random.default_rng(4).random((90, 90, 1, 3)) * numpy.ones((1, 1, 180, 1))
        table[numpy.minimum(*merl.cosines()) <= 0] = -1
        found = bivariate(table, 90)
        valid = table[:, :, 90, 0] >= 0
        numpy.testing.assert_allclose(found[:, :, 0][valid], table[:, :, 90][valid])
        self.assertEqual(found[:, :, 0][~valid].max(), -1)
        table[5, 5, ::2] = 1
        table[5, 5, 1::2] = 3
        self.assertTrue((1.2 < bivariate(table, 90)[5, 5]).all())
        self.assertTrue((bivariate(table, 90)[5, 5] < 2).all())  # the dark ones weigh more

    def test_bivariate_of_fewer_bins_is_a_mean_over_them(self):
        bivariate = load("appearance", "bivariate").bivariate
        table = numpy.random.default_rng(4).random((90, 90, 1, 3)) * numpy.ones((1, 1, 180, 1))
        each, three = bivariate(table, 90), bivariate(table, 30)
        self.assertEqual(three.shape, each.shape)
        of_bin = each.reshape(90, 30, 3, 3)
        numpy.testing.assert_array_equal(three[:, ::3], three[:, 2::3])
        self.assertTrue((three[:, ::3, 0] >= of_bin.min(axis=2) - 1e-12).all())
        self.assertTrue((three[:, ::3, 0] <= of_bin.max(axis=2) + 1e-12).all())

    def test_a_published_fit_is_its_formula(self):
        (self.folder / "x.fit").write_text(
            "# none\npaint = Aggregate(Lambertian(albedo = [0.1, 0.2, 0.3]), "
            "NganWard(albedo = [0.03, 0.02, 1e-2], roughness = 0.2))\n")
        table = load("appearance", "published_table").table(self.folder / "x.fit", "paint")
        h, d, p = 20, 15, 40
        cos_i, cos_o = (of[h, d, p] for of in merl.cosines())
        tan = numpy.tan(merl.angles()[0][h, d, p])
        lobe = numpy.exp(-tan ** 2 / 0.04) / (4 * numpy.pi * 0.04 * numpy.sqrt(cos_i * cos_o))
        expected = numpy.array([0.1, 0.2, 0.3]) / numpy.pi + numpy.array([0.03, 0.02, 0.01]) * lobe
        numpy.testing.assert_allclose(table[h, d, p], expected * [1, 1.15, 1.66], rtol=1e-5)
        self.assertEqual(table[80, 80, 0, 0], -1)


class PicturesTest(FolderTest):
    def test_measures_of_a_known_difference(self):
        measured = numpy.full((4, 4, 3), 0.7)
        counts = numpy.ones((4, 4), bool)
        counts[0] = False
        fitted = measured * 1.1
        fitted[0] = 100  # no pixel counts here
        scores = pictures.compare(measured, fitted, counts)
        # Shown at 0.35 and 0.385, on the sRGB curve; linear, the peak is 0.35.
        shown = [1.055 * x ** (1 / 2.4) - 0.055 for x in (0.35, 0.385)]
        self.assertAlmostEqual(scores["psnr_db"], -20 * numpy.log10(shown[1] - shown[0]))
        self.assertAlmostEqual(scores["linear_psnr_db"], 20, delta=1e-9)
        self.assertEqual(pictures.compare(measured, measured, counts)["psnr_db"], float("inf"))
        numpy.testing.assert_allclose(pictures.encoded(numpy.array([-1.0, 0.0, 1.0, 9.0])),
                                      [0, 0, 1, 1], atol=1e-12)

    def test_pictures_of_a_matt_sphere(self):
        """The whole way: paths, tables, pictures, under a sky that fades towards the ground."""
        paths = load("renderer", "light_paths")
        options = scene.parser("").parse_args(["--size=16x16"])
        options.positions, options.lights, options.directions = 4, 64, False
        matt = numpy.full((*merl.SHAPE, 3), 0.5 / numpy.pi)
        matt[numpy.minimum(*merl.cosines()) <= 0] = -1
        half = numpy.where(matt > 0, matt / 2, -1)
        found = paths.paths(options)
        rows = load("appearance", "bins.py").rows(matt, [half])
        (measured, fitted), share = load("appearance", "render").render(found, rows)
        numpy.testing.assert_allclose(fitted, measured / 2, rtol=1e-5)
        self.assertEqual(share[0, 0], -1)
        numpy.testing.assert_allclose(share[8, 8], 1, rtol=1e-5)
        self.assertGreater(measured[3, 8, 0], 1.3 * measured[12, 8, 0])
        # A matt sphere shows its irradiance over pi, times its albedo of a half.
        lit = numpy.zeros((256, 3))
        numpy.add.at(lit, found["pixel"],
                     found["light"].astype(float).sum(axis=1) * found["unit"])
        numpy.testing.assert_allclose(measured.reshape(-1, 3), lit * 0.5 / numpy.pi, atol=1e-4)


if __name__ == "__main__":
    unittest.main()
