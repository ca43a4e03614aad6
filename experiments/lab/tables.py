"""Tables as lists of rows, a row a dict: to and from CSV, and as Markdown."""
import csv


def _text(value):
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.10g}"
    return str(value)


def _value(text):
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
        return [{key: _value(text) for key, text in row.items()} for row in csv.DictReader(file)]


def groups(rows, *keys):
    """{value of the key, or tuple of the values of several: rows}, in the order of the rows."""
    found = {}
    for row in rows:
        value = tuple(row[key] for key in keys)
        found.setdefault(value if len(keys) > 1 else value[0], []).append(row)
    return found


def markdown(header, rows):
    """A Markdown table of cells that are text already."""
    lines = ["| " + " | ".join(header) + " |", "|" + " --- |" * len(header)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines) + "\n"
