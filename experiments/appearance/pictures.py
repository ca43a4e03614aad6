"""How far apart two pictures are, and pictures as files show them."""
import importlib.util

import numpy

EXPOSURE = 0.35  # mean luminance that the measured picture is exposed to
LUMINANCE = numpy.array([0.2126, 0.7152, 0.0722])


def exposure(measured, counts):
    """The factor with which both pictures are shown."""
    mean = (measured[counts] @ LUMINANCE).mean()
    return EXPOSURE / mean if mean > 0 else 1.0


def encoded(linear):
    """Clipped at 1 and encoded by the sRGB curve, in [0, 1]."""
    x = numpy.clip(linear, 0, 1)
    return numpy.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def psnr(a, b, peak=1.0):
    """Over all values, dB; infinite for equal ones."""
    error = numpy.mean((a - b) ** 2)
    return float(10 * numpy.log10(peak ** 2 / error)) if error > 0 else float("inf")


def flip(a, b, counts):
    """Mean FLIP (Andersson et al. 2020, LDR, 67 pixels a degree) over what counts; None without
    flip-evaluator."""
    if importlib.util.find_spec("flip_evaluator") is None:
        return None
    import flip_evaluator
    differences = flip_evaluator.evaluate(*(numpy.where(counts[..., None], of, 0).astype("f4")
                                            for of in (a, b)), "LDR", applyMagma=False)[0]
    return float(numpy.asarray(differences).reshape(counts.shape)[counts].mean())


def compare(measured, fitted, counts):
    """All measures of two linear pictures [height][width][3]; counts: the pixels that do."""
    factor = exposure(measured, counts)
    shown = [encoded(of * factor) for of in (measured, fitted)]
    linear = [of[counts] * factor for of in (measured, fitted)]
    return {"psnr_db": psnr(shown[0][counts], shown[1][counts]),
            "linear_psnr_db": psnr(*linear, peak=linear[0].max()),
            "flip": flip(*shown, counts)}
