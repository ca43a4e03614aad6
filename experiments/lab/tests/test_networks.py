"""Networks as tables in MERL layout, for spheres to compare with."""
import pathlib
import subprocess
import sys
import unittest

import numpy

from lab.tests import FolderTest

PROGRAM = pathlib.Path(__file__).resolve().parents[2] / "spheres" / "network_tables"
NUMBERS = 675
BELOW = 361784  # bins with a direction below the surface, as `trilobe info` counts them


class NetworksTest(FolderTest):
    def table(self, numbers, *flags):
        """The planes that a network becomes. [3][theta_h][theta_d][phi_d]"""
        numpy.savez(self.folder / "networks.npz", one=numbers)
        subprocess.run([sys.executable, str(PROGRAM), str(self.folder / "networks.npz"),
                        str(self.folder), *flags], check=True)
        with open(self.folder / "one.binary", "rb") as file:
            self.assertEqual(list(numpy.fromfile(file, "<i4", 3)), [90, 90, 180])
            return numpy.fromfile(file, "<f8").reshape(3, 90, 90, 180)

    def test_a_constant_is_stored_in_the_units_of_each_channel(self):
        numbers = numpy.zeros(NUMBERS)
        numbers[-3:] = numpy.log(1 + numpy.array([0.5, 1.0, -0.5]))
        planes = self.table(numbers)
        for plane, value in zip(planes, (0.5 * 1500, 1500 / 1.15, 0)):
            self.assertEqual((plane == -1).sum(), BELOW)
            numpy.testing.assert_allclose(plane[plane != -1], value, rtol=1e-12)

    def test_of_rgl_the_difference_vector_is_turned(self):
        numbers = numpy.zeros(NUMBERS)
        # x of the difference vector into the first unit, from there into the next, and into red.
        numbers[[3 * 21, 7 * 21, NUMBERS - 22 * 3]] = 1
        merl, rgl = self.table(numbers)[0], self.table(numbers, "--rgl")[0]
        self.assertGreater(merl[10, 30, 10], 0)  # phi_d of 10.5 degrees: x > 0
        self.assertEqual(merl[10, 30, 170], 0)
        numpy.testing.assert_allclose(rgl, merl[:, :, ::-1], atol=1e-9)


if __name__ == "__main__":
    unittest.main()
