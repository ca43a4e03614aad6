"""BSDFs of our own for Mitsuba, of which only the value has to be told."""
from renderer import light_lobes


def sampled(mi):
    """A base class of BSDFs, drawn from lobes of several widths and a cosine.

    `value(wi, wo)` of what derives from it is the BRDF for directions above the surface. Mitsuba's
    local frame has x where the shape's u grows, made normal to the shading normal.
    """
    import drjit as dr

    class Sampled(mi.BSDF):
        """Reflects on the front side."""

        def __init__(self, properties):
            mi.BSDF.__init__(self, properties)
            self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide]
            self.m_flags = self.m_components[0]

        def _density(self, wi, wo):
            h = dr.normalize(wi + wo)
            total = wo.z / dr.pi
            for alpha in light_lobes.LOBES:
                total += light_lobes.density(alpha, h.z, dr.dot(wo, h), dr.maximum)
            return total / (1 + len(light_lobes.LOBES))

        def sample(self, ctx, si, sample1, sample2, active=True):
            lobes = light_lobes.LOBES
            choice = mi.Int(sample1 * (1 + len(lobes)))
            wo = mi.warp.square_to_cosine_hemisphere(sample2)
            for k, alpha in enumerate(lobes):
                cosine = dr.sqrt((1 - sample2.x) / (1 + (alpha ** 2 - 1) * sample2.x))
                sine = dr.safe_sqrt(1 - dr.square(cosine))
                s, c = dr.sincos(2 * dr.pi * sample2.y)
                h = mi.Vector3f(sine * c, sine * s, cosine)
                wo = dr.select(choice == k, 2 * dr.dot(si.wi, h) * h - si.wi, wo)
            sample = mi.BSDFSample3f()
            sample.wo, sample.eta = wo, 1
            sample.sampled_component = mi.UInt32(0)
            sample.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
            sample.pdf = self.pdf(ctx, si, wo, active)
            value = self.eval(ctx, si, wo, active)
            return sample, dr.select(sample.pdf > 0, value / sample.pdf, 0)

        def eval(self, ctx, si, wo, active=True):
            up = (si.wi.z > 0) & (wo.z > 0)
            return dr.select(up & active, self.value(si.wi, wo) * wo.z, 0)

        def pdf(self, ctx, si, wo, active=True):
            up = (si.wi.z > 0) & (wo.z > 0)
            return dr.select(up & active, self._density(si.wi, wo), 0)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

        def to_string(self):
            return f"{type(self).__name__}[]"

    return Sampled
