"""Stiff and extreme cases: see README.md beside this file."""
import json
import pathlib
import statistics

from lab import tables
from lab.units import FOLDER, Unit

ANSWERS = pathlib.Path(__file__).with_name("certified.json")
# Marks of cells besides digits, by how the run ended.
MARKS = {"certified": "", "other": "*", "elsewhere": "", "below": " below"}


def _certificates():
    return json.loads(ANSWERS.read_text())["certificates"]


def units(setting):
    """A unit for each case, with all solvers in it."""
    known = [certificate["name"] for certificate in _certificates()]
    wanted = setting.manifest["cases"]
    return [Unit(f"stiff/{name}", setting.program("stiff"),
                 (f"--case={name}", f"--max_iterations={setting.manifest['max_iterations']}",
                  f"--answers={ANSWERS}", f"--out={FOLDER}/results.json"),
                 product="results.json", labels={"case": name})
            for name in known if wanted == "all" or name in wanted]


def tabulate(_, results):
    made = [result for result in results if result.folder]
    rows = []
    for result in made:
        for row in json.loads((result.folder / "results.json").read_text()):
            row["notes"] = "; ".join(row.get("notes", []))
            rows.append(row)
    names = {result.labels["case"] for result in results}
    solvers = list(dict.fromkeys(row["solver"] for row in rows))
    rows += [{"case": result.labels["case"], "description": "", "model": "", "solver": solver,
              "error": "missing"} for result in results if not result.folder for solver in solvers]
    answers = []
    for of in _certificates():
        if of["name"] not in names:
            continue
        description = next((row["description"] for row in rows if row["case"] == of["name"]), "")
        answers.append({
            "case": of["name"], "description": description, "samples": of["samples"],
            "parameters": of["parameters"], "objective": of["objective"],
            "measured_energy": of["measured_energy"], "exact": str(of["exact"]).lower(),
            "relative_decrease": of["relative_decrease"], "optimality": of["optimality"],
            "starts": of["starts"], "agreeing": of["agreeing"], "others": len(of["others"]),
            "flat_directions": of["flat_directions"], "rank": of["rank"],
            "condition": of["condition"],
            "determined": of["parameters"] - len(of["undetermined"])})
    return {"results": rows, "answers": answers}


def _digits(row, column):
    return None if row is None or row.get("error") else row[column]


def _matrix(rows, answers, column, title):
    """Digits by case (down) and solver (across); blank where there is nothing to compare."""
    from lab import plots
    solvers = list(dict.fromkeys(row["solver"] for row in rows))
    cases = [answer["case"] for answer in answers]
    row_of = {(row["case"], row["solver"]): row for row in rows}
    figure, axes = plots.plt.subplots(figsize=(10.5, 0.27 * len(cases) + 2))
    # cividis: even in brightness, and the same for colour-blind eyes; bright is good.
    colours = plots.plt.get_cmap("cividis")
    for i, answer in enumerate(answers):
        for j, solver in enumerate(solvers):
            row = row_of.get((answer["case"], solver))
            digits = _digits(row, column)
            undetermined = column != "digits_objective" and answer["determined"] == 0
            if digits is None or undetermined:
                axes.add_patch(plots.plt.Rectangle((j - 0.5, i - 0.5), 1, 1, color="#EEEEEE"))
                axes.text(j, i, "–" if undetermined else "error", ha="center", va="center",
                          fontsize=8, color=plots.GREY)
                continue
            axes.add_patch(plots.plt.Rectangle((j - 0.5, i - 0.5), 1, 1,
                                               color=colours(digits / 15)))
            mark = MARKS[row["end"]] if column == "digits_objective" else ""
            axes.text(j, i, f"{digits:.1f}{mark}", ha="center", va="center",
                      fontsize=8, color="black" if digits > 8 else "white")
    axes.set(xlim=(-0.5, len(solvers) - 0.5), ylim=(len(cases) - 0.5, -0.5))
    axes.set_xticks(range(len(solvers)), solvers, rotation=35, ha="left")
    axes.xaxis.tick_top()
    axes.set_yticks(range(len(cases)), cases)
    condition = axes.twinx()
    condition.set_ylim(axes.get_ylim())
    condition.set_yticks(range(len(cases)), [f"{answer['condition']:.0e}" for answer in answers])
    condition.set_ylabel("condition number of J at the certified minimum")
    for of in (axes, condition):
        of.grid(visible=False)
        of.tick_params(length=0)
        for spine in of.spines.values():
            spine.set_visible(False)
    axes.set_title(title, pad=12)
    return figure


def draw(drawn, _):
    rows, answers = drawn["results"], drawn["answers"]
    summary = []
    for (model, solver), of in tables.groups(rows, "model", "solver").items():
        able = [row for row in of if not row.get("error")]
        if not able:
            summary.append([model, solver, f"0 of {len(of)}"] + [""] * 9)
            continue
        digits = sorted(row["digits_objective"] for row in able)
        fitted = [row["digits_tables"] for row in able
                  if next(a for a in answers if a["case"] == row["case"])["determined"]]
        found = sum(row["end"] == "certified" for row in able)
        summary.append([
            model, solver, f"{len(able)} of {len(of)}", str(found),
            str(sum(row["end"] == "other" for row in able)), f"{statistics.median(digits):.1f}",
            f"{digits[0]:.1f}", f"{statistics.median(fitted):.1f}" if fitted else "–",
            str(sum(str(row["valid"]) != "True" for row in able)),
            str(sum(str(row["rise_over_start"]) == "True" for row in able)),
            f"{max(row['worst_rise'] for row in able):.0e}",
            f"{sum(row['seconds'] for row in able):.1f}"])
    header = ["model", "solver", "cases", "at the certified E", "at another minimum",
              "digits of E, median", "worst", "digits of tables, median", "not a number",
              "above the start", "worst rise in one iteration", "seconds, all"]
    certified = [[answer["case"], answer["description"] or "", str(answer["samples"]),
                  f"{answer['objective']:.6g}", f"{answer['measured_energy']:.4g}",
                  f"{answer['agreeing']} of {answer['starts']}", str(answer["others"]),
                  f"{answer['optimality']:.0e}", f"{answer['rank']}",
                  f"{answer['determined']} of {answer['parameters']}",
                  f"{answer['condition']:.1e}"] for answer in answers]
    return {
        "objective": _matrix(rows, answers, "digits_objective",
                             "Digits of E in agreement with the certified minimum (0 to 15)"),
        "tables": _matrix(rows, answers, "digits_tables",
                          "Digits of the canonical tables, the worst table of each fit (0 to 15)"),
        "summary.md": tables.markdown(header, summary),
        "answers.md": tables.markdown(
            ["case", "what is hard", "samples", "certified E", "E of a black model",
             "starts that agree", "other minima", "optimality", "rank of J", "determined",
             "condition"], certified)}
