"""Tables as lists of rows, a row a dict: to and from CSV, and as Markdown."""
import csv
import itertools
import math


def _text(value):
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.10g}"
    return str(value)


# Columns of names, which stay text though one may look like a number.
NAMES = {"material", "solver", "start", "weighting", "fitted_by", "scored_by", "run", "case", "fit",
         "unit", "source_xxh128"}


def _value(key, text):
    if key in NAMES:
        return text
    if text == "":
        return None
    for read in (int, float):
        try:
            return read(text)
        except ValueError:
            pass
    return text


def write(path, rows):
    """Writes a CSV; columns are the keys in the order in which they first occur."""
    columns = list(dict.fromkeys(key for row in rows for key in row))
    with open(path, "w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows([_text(row.get(column)) for column in columns] for row in rows)


def read(path):
    """Rows; numbers as numbers, inf and nan among them, empty cells as None."""
    with open(path, newline="") as file:
        return [{key: _value(key, text) for key, text in row.items()}
                for row in csv.DictReader(file)]


def groups(rows, *keys):
    """{value of the key, or tuple of the values of several: rows}, in the order of the rows."""
    found = {}
    for row in rows:
        value = tuple(row[key] for key in keys)
        found.setdefault(value if len(keys) > 1 else value[0], []).append(row)
    return found


def quartiles(values, form=".3g"):
    """"median [first, third quartile]" of what is known: None and nan are not, and their number is
    told; – for what is infinite."""
    from lab import stats  # here: it needs numpy, without which the experiments can be listed
    known = [value for value in values if value is not None and not math.isnan(value)]
    low, middle, high = (format(value, form) if math.isfinite(value) else "–" for value in stats.spread(known, .25))
    of = f" (n = {len(known)})" if 0 < len(known) < len(values) else ""
    return "–" if middle == "–" else f"{middle} [{low}, {high}]{of}"


def with_missing(rows, missing, *keys):
    """{key: (rows, how many are missing)}, keys as those of `groups`; no rows where all are."""
    found, lost = groups(rows, *keys), groups(missing, *keys)
    return {key: (found.get(key, []), len(lost.get(key, []))) for key in [*found, *lost]}


def paired(ends, tolerance):
    """A line each two solvers: on how many materials each ends lower than the other by more than the tolerance, and
    the sign test's p. ends: {solver: {material: E}}; a pair counts the materials that both have."""
    from lab import stats  # here: as above
    lines = []
    for one, other in itertools.combinations(ends, 2):
        both = sorted(ends[one].keys() & ends[other].keys())
        lower, higher, p = stats.sign_test([ends[one][name] for name in both], [ends[other][name] for name in both],
                                           tolerance)
        lines.append([one, other, str(lower), str(higher), str(len(both) - lower - higher), f"{p:.2g}"])
    return markdown(["solver", "other", "solver lower", "other lower", "alike", "p"], lines)


def count(rows, missing):
    """"12, 1 missing": the number of rows, those of missing fits among them."""
    return f"{rows}, {missing} missing" if missing else str(rows)


def markdown(header, rows):
    """A Markdown table of cells that are text already."""
    lines = ["| " + " | ".join(header) + " |", "|" + " --- |" * len(header)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines) + "\n"
