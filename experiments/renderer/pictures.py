"""Differences between two pictures, and pictures as files show them."""
import importlib.util
import io

import numpy
from PIL import Image, ImageDraw, ImageFont

EXPOSURE = 0.35  # mean luminance that the measured picture is exposed to
LUMINANCE = numpy.array([0.2126, 0.7152, 0.0722])
PAGE_BYTES = 300_000  # at most


def exposure(measured, counts):
    """The factor with which both pictures are shown."""
    mean = (measured[counts] @ LUMINANCE).mean()
    return EXPOSURE / mean if mean > 0 else 1.0


def encoded(linear):
    """Clipped at 1 and encoded by the sRGB curve, in [0, 1]."""
    x = numpy.clip(linear, 0, 1)
    return numpy.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def psnr(a, b, peak=1.0):
    """The PSNR over all values, dB; infinite for equal ones."""
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


def _jpeg(page):
    """The best that is small enough for a page, or else the smallest."""
    for quality in (92, 88, 82, 75, 65, 50):
        text = io.BytesIO()
        page.save(text, "JPEG", quality=quality, optimize=True)
        if text.tell() <= PAGE_BYTES:
            break
    return text.getvalue()


def side_by_side(rows, width=190):
    """A JPEG of rows (caption, [(picture, text below it)]); pictures [height][width][3] are encoded
    values in [0, 1], shown so many pixels wide."""
    from matplotlib import font_manager
    path = font_manager.findfont("DejaVu Sans")
    large, small = (ImageFont.truetype(path, size) for size in (15, 12))
    scaled = []
    for caption, shown in rows:
        images = [Image.fromarray((255 * of + 0.5).astype("u1")) for of, _ in shown]
        scaled.append((caption, [
            (of.resize((width, width * of.height // of.width), Image.LANCZOS), text)
            for of, (_, text) in zip(images, shown)]))
    across = max((len(shown) for _, shown in scaled), default=1) * (width + 10)
    page = Image.new("RGB", (across + 20, sum(shown[0][0].height + 70 for _, shown in scaled) + 10),
                     "white")
    pen, y = ImageDraw.Draw(page), 10
    for caption, shown in scaled:
        pen.text((10, y), caption, "#111111", large)
        for k, (picture, text) in enumerate(shown):
            page.paste(picture, (10 + k * (width + 10), y + 24))
            pen.text((10 + k * (width + 10), y + 26 + picture.height), text, "#444444", small)
        y += shown[0][0].height + 70
    return _jpeg(page)
