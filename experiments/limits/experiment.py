"""Other forms than the paper's, and what they are worth: see README.md beside this file."""
import json

from lab import fits, stats, tables
from lab.units import FOLDER, Product, Unit

EQUAL = 0.01  # relative to E, or dB of the sphere: no difference
COLUMNS = ("parameters", "relative_objective", "of_paper", "held_out_objective", "held_out_of_paper",
           "sphere_psnr_db", "sphere_mean_delta_e", "steps", "converged", "seconds")


def units(setting):
    """The default fit of each source, and all forms from that."""
    manifest = setting.manifest
    made = []
    for source in setting.every(manifest["every"]):
        fit = fits.fit(setting, source, manifest["flags"].get("solver", "auto"),
                       {key: value for key, value in manifest["flags"].items() if key != "solver"})
        made += [fit, Unit(f"forms/{source.name}", setting.program("forms"),
                           (Product(fit, "model.json"), source.path,
                            f"--forms={','.join(manifest['forms'])}", f"--out={FOLDER}",
                            *fits.words(setting.reading(source))), "forms.json",
                           labels={"material": source.name, "run": "forms"})]
    return made


def tabulate(setting, results):
    """A row for each material and form."""
    database = {source.name: source.database for source in setting.sources}
    rows = []
    for result in results:
        if result.labels.get("run") != "forms" or not result.folder:
            continue
        name = result.labels["material"]
        rows += [{"material": name, "database": database[name], "form": form["form"],
                  **{column: form.get(column) for column in COLUMNS}}
                 for form in json.loads((result.folder / "forms.json").read_text())["forms"]]
    return {"forms": rows}


def _summary(rows):
    """A line a form, against the paper's on the same material."""
    paper = {row["material"]: row for row in rows if row["form"] == "paper"}
    lines = []
    for form, of in tables.groups(rows, "form").items():
        lower, higher, p = stats.sign_test([row["held_out_of_paper"] for row in of], [1.0] * len(of), EQUAL)
        gains = [row["sphere_psnr_db"] - paper[row["material"]]["sphere_psnr_db"] for row in of]
        seen = [row["sphere_mean_delta_e"] - paper[row["material"]]["sphere_mean_delta_e"] for row in of]
        lines.append([form, tables.quartiles([row["parameters"] for row in of], ".0f"),
                      tables.quartiles([row["of_paper"] for row in of], ".3f"),
                      tables.quartiles([row["held_out_of_paper"] for row in of], ".3f"),
                      f"{lower} / {higher}", f"{p:.2g}",
                      tables.quartiles(gains, "+.2f"), tables.quartiles(seen, "+.2f")])
    return tables.markdown(["form", "numbers", "E, of the paper's", "held out", "lower / higher", "p",
                            "sphere, dB", "mean ΔE"], lines)


def _figure(rows):
    """E of held-out blocks, of the paper's; a line a material, a colour a form."""
    from lab import plots
    others = [form for form in tables.groups(rows, "form") if form != "paper"]
    of_form = {form: {row["material"]: row["held_out_of_paper"] for row in rows if row["form"] == form}
               for form in others}
    first = of_form[others[0]]
    materials = sorted(first, key=lambda name: first[name])
    figure, axes = plots.plt.subplots(figsize=(8, 1.4 + 0.26 * len(materials)))
    for form, colour in zip(others, plots.SERIES):
        of = of_form[form]
        axes.plot([of[name] for name in materials], range(len(materials)), "o", color=colour, label=form,
                  markersize=4)
    axes.axvline(1, color=plots.GREY, linewidth=1)
    axes.set_xscale("log")
    plots.plain_numbers(axes.xaxis)
    axes.set(yticks=range(len(materials)), yticklabels=materials,
             xlabel="E on held-out blocks of directions, as a share of the paper's form's")
    plots.legend_above(figure, axes, columns=3)
    return figure


def draw(drawn, _):
    rows = drawn["forms"]
    if not rows:
        return {}
    return {"summary.md": _summary(rows), "held_out": _figure(rows)}
