"""The share of the difference between two pictures that is noise of their paths."""
import numpy

from lab import tables
from renderer import pictures

AGAIN = 2  # the seed of the second pictures, that tell the noise


def rows(folder_of, reference):
    """Differences between pictures of independent paths, and from the reference.

    folder_of: {(material, scene, seed): folder of pictures.npz}, which has `share`, the reference
    and what is held against it
    """
    found = []
    for (material, scene, seed), folder in folder_of.items():
        if seed != AGAIN or (material, scene, 1) not in folder_of:
            continue
        one, two = (dict(numpy.load(of / "pictures.npz"))
                    for of in (folder_of[material, scene, 1], folder))
        counts = (one["share"] > 0) & (two["share"] > 0)
        factor = pictures.exposure(one[reference], counts)
        for fit in (name for name in one if name not in (reference, "share")):
            shown = [[pictures.encoded(of[name] * factor)[counts] for name in (reference, fit)]
                     for of in (one, two)]
            found.append({
                "material": material, "scene": scene, "fit": fit,
                "psnr_db": pictures.psnr(*shown[0]), "again_psnr_db": pictures.psnr(*shown[1]),
                "noise_db": pictures.psnr(shown[0][0], shown[1][0]),
                "difference_noise_db": pictures.psnr(shown[0][1] - shown[0][0],
                                                     shown[1][1] - shown[1][0])})
    return found


def table(found, reference):
    """Markdown of the rows. reference: "a measurement" """
    lines = []
    for (scene, fit), of in tables.groups(found, "scene", "fit").items():
        below = [row["difference_noise_db"] - row["psnr_db"] for row in of]
        lines.append([scene, fit, str(len(of)),
                      tables.quartiles([row["noise_db"] for row in of], ".1f"),
                      tables.quartiles([row["difference_noise_db"] for row in of], ".1f"),
                      f"{min(below):.1f}",
                      f"{max(abs(row['psnr_db'] - row['again_psnr_db']) for row in of):.2f}"])
    return tables.markdown(["scene", "fit", "n", f"two pictures of {reference}, dB apart",
                            "two pictures of a difference, dB apart",
                            "least that this is below the difference, dB",
                            "most that a PSNR differs, dB"], lines)
