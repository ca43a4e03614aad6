"""Tables in MERL layout (docs/file-formats.md): where their bins are, and how to read and write
them. In memory a table is [theta_h 90][theta_d 90][phi_d 180][channel 3], in 1/sr."""
import numpy

SHAPE = (90, 90, 180)  # theta_h, theta_d, phi_d
STORED = (1 / 1500, 1.15 / 1500, 1.66 / 1500)  # 1/sr of a stored 1, by channel


def angles():
    """theta_h, theta_d and phi_d at the centres of the bins, in radians. [SHAPE] each"""
    h, d, p = numpy.meshgrid(*(numpy.arange(n) + 0.5 for n in SHAPE), indexing="ij")
    return tuple(numpy.radians(a) for a in ((h / 90) ** 2 * 90, d, p))


def cosines():
    """Cosines of theta_i and theta_o at the centres of the bins. [SHAPE] each"""
    theta_h, theta_d, phi_d = angles()
    up = numpy.cos(theta_h) * numpy.cos(theta_d)
    across = numpy.sin(theta_h) * numpy.sin(theta_d) * numpy.cos(phi_d)
    return up - across, up + across


def read(path):
    """The table of a file; below 0 where a bin is invalid. Raises ValueError for another file."""
    with open(path, "rb") as file:
        header = numpy.fromfile(file, "<i4", 3)
        planes = numpy.fromfile(file, "<f8")
    if tuple(header) != SHAPE or planes.size != 3 * numpy.prod(SHAPE):
        raise ValueError(f"{path} is not in MERL layout (90, 90, 180)")
    return numpy.moveaxis(planes.reshape(3, *SHAPE), 0, -1) * STORED


def write(path, table):
    """Writes a table; what is below 0 or not finite is marked invalid, -1."""
    planes = numpy.moveaxis(table / STORED, -1, 0)
    invalid = ~(numpy.isfinite(planes) & (planes >= 0)).all(axis=0)
    with open(path, "wb") as file:
        numpy.array(SHAPE, "<i4").tofile(file)
        numpy.where(invalid, -1.0, planes).astype("<f8").tofile(file)
