"""Lobes about the half vector that directions are drawn from, whatever the material."""
import math

LOBES = (0.008, 0.03, 0.12, 0.4)  # widths, GGX's alpha


def density(alpha, cos_h, cos_d, maximum):
    """Density of the light's direction, by solid angle, where half vectors have D cos(theta_h)."""
    a2 = alpha ** 2
    D = a2 / (math.pi * (cos_h * cos_h * (a2 - 1) + 1) ** 2)
    return D * cos_h / (4 * maximum(cos_d, 1e-6))
