#!/usr/bin/env python3
"""The tables of docs/results.md, from what `octalux-bench all --json` printed.

    bench/record.py [FOUND.json ...]   take what was found over into docs/results.json, and write the tables anew
    bench/record.py --check            fail when a table of docs/results.md is not what docs/results.json says

FOUND.json may be of `octalux-bench all` or of single experiments, which then take the place of the same ones found earlier. Of an experiment
with `--only SCENE` the rows of that scene do, and the others stay; with `--probes SET` besides, those of that set of probes. In docs/results.md a table lies between two comments:

    <!-- EXPERIMENT TABLE [columns: KEY KEY ...] [where: KEY=VALUE,VALUE ...] -->
    <!-- end -->

Columns are all of the table's unless they are named; `where` keeps rows. The table `times` of the experiment `all` lists
what each experiment took.
"""
import json
import os
import re
import sys

DOCS = os.path.join(os.path.dirname(os.path.dirname(os.path.abspath(__file__))), "docs")
BLOCK = re.compile(r"(<!-- ([a-z0-9-]+) ([a-z0-9-]+)((?: [a-z]+:[^>]*?)?) -->\n)(.*?)(<!-- end -->)", re.S)


def number_text(value, column):
    """As `octalux-bench` prints it."""
    if value is None:
        return ""
    share = column.get("unit") == "share"
    shown = 100 * value if share else value
    if abs(shown) < 1e7 and shown == round(shown):
        text = "%.0f" % shown
    elif 1000 <= abs(shown) < 1e7:
        text = "%.0f" % shown
    else:
        text = "%.3g" % shown
    return text + (" %" if share else "")


def cell(row, column):
    value = row[column["key"]]
    return value if column["kind"] == "name" else number_text(value, column)


def heading(column):
    unit = column.get("unit")
    return column["name"] + (", " + unit if unit and unit != "share" else "")


def markdown(head, rows):
    lines = [head, ["---"] * len(head)] + rows
    return "".join("| " + " | ".join(line) + " |\n" for line in lines)


def times(record):
    """What each experiment took, and all of them."""
    rows = [[e["experiment"], "%.0f" % e["seconds"], "%.0f" % e["processor_seconds"]] for e in record["experiments"]]
    sums = ["%.1f min" % (sum(e[key] for e in record["experiments"]) / 60) for key in ("seconds", "processor_seconds")]
    return markdown(["experiment", "seconds", "of all processors"], rows + [["all", *sums]])


def selection(text):
    """The words behind `columns:` and `where:`."""
    found = {"columns": [], "where": []}
    for name, words in re.findall(r"([a-z]+): ([^:]*?)(?= [a-z]+: |$)", text.strip()):
        found[name] = words.split()
    wanted = [word.split("=", 1) for word in found["where"]]
    return found["columns"], [(key, values.split(",")) for key, values in wanted]


def table_text(record, experiment, name, text):
    if (experiment, name) == ("all", "times"):
        return times(record)
    found = [t for e in record["experiments"] if e["experiment"] == experiment for t in e["tables"] if t["name"] == name]
    if not found:
        sys.exit("record: docs/results.json has no table %s of %s" % (name, experiment))
    keys, where = selection(text)
    by_key = {column["key"]: column for column in found[0]["columns"]}
    unknown = [key for key in keys + [key for key, _ in where] if key not in by_key]
    if unknown:
        sys.exit("record: table %s of %s has no column %s" % (name, experiment, ", ".join(unknown)))
    columns = [by_key[key] for key in keys] or found[0]["columns"]
    rows = [row for row in found[0]["rows"] if all(cell(row, by_key[key]) in values for key, values in where)]
    return markdown([heading(column) for column in columns], [[cell(row, column) for column in columns] for row in rows])


def written(record, text):
    return BLOCK.sub(lambda m: m.group(1) + "\n" + table_text(record, m.group(2), m.group(3), m.group(4)) + "\n" + m.group(6), text)


def part_of(command):
    """The scenes that a command measures, and the set of probes where it names one."""
    return tuple(found.group(1) if found else "" for found in (re.search(option + r" (\S+)", command) for option in ("--only", "--probes")))


def parts_with(parts, part, took):
    """What each part took: a whole scene takes the place of its sets of probes, and a set of probes that of its whole scene."""
    scene, probes = part
    gone = {scene, " ".join(part)} if probes else {name for name in parts if name.split()[0] == scene}
    return {**{name: old for name, old in parts.items() if name not in gone}, " ".join(part).strip(): took}


def joined(old, new):
    """The rows of one scene, or of one set of its probes, in their place among the others, and what each such part took."""
    part = part_of(new["command"])
    parts = parts_with(old.get("parts", {}), part, {key: new[key] for key in ("seconds", "processor_seconds")})
    for table, fresh in zip(old["tables"], new["tables"]):
        keys = [table["columns"][0]["key"]] + ["probes"] * bool(part[1])
        names = {tuple(row.get(key) for key in keys) for row in fresh["rows"]}
        replaced = [tuple(row.get(key) for key in keys) in names for row in table["rows"]]
        place = replaced.index(True) if True in replaced else len(replaced)
        kept = [[row for row, gone in zip(table["rows"][a:b], replaced[a:b]) if not gone] for a, b in ((0, place), (place, len(replaced)))]
        table["rows"] = kept[0] + fresh["rows"] + kept[1]
    sums = {key: sum(part[key] for part in parts.values()) for key in ("seconds", "processor_seconds")}
    return {**old, **sums, "parts": parts}


def begun(new):
    """An experiment of several scenes that has none of them yet."""
    tables = [{**table, "rows": []} for table in new["tables"]]
    return {**new, "command": "octalux-bench " + new["experiment"], "tables": tables, "skipped": []}


def merged(record, paths):
    """In the order of the experiments' list, which `bench all` has."""
    for path in paths:
        with open(path, encoding="utf-8") as file:
            found = json.load(file)
        if "experiments" in found:
            record = record or {**found, "command": "octalux-bench all --json"}
        for experiment in found.get("experiments", [found]):
            at = [i for i, e in enumerate(record["experiments"]) if e["experiment"] == experiment["experiment"]]
            one_scene = "--only" in experiment["command"]
            if not at and not one_scene:
                sys.exit("record: %s: docs/results.json has no experiment %s" % (path, experiment["experiment"]))
            if not at:
                record["experiments"].append(begun(experiment))
                at = [len(record["experiments"]) - 1]
            record["experiments"][at[0]] = joined(record["experiments"][at[0]], experiment) if one_scene else experiment
    return record


def save(record, path):
    """A row a line, so that changes can be read."""
    with open(path, "w", encoding="utf-8") as file:
        text = json.dumps(record, ensure_ascii=False, indent=1)
        file.write(re.sub(r"\{\n\s+(\"(?:[^{}\[\]])*?)\n\s+\}", lambda m: "{" + re.sub(r"\n\s+", " ", m.group(1)) + "}", text) + "\n")


def main():
    record_path, results_path = os.path.join(DOCS, "results.json"), os.path.join(DOCS, "results.md")
    arguments = sys.argv[1:]
    record = None
    if os.path.exists(record_path):
        with open(record_path, encoding="utf-8") as file:
            record = json.load(file)
    with open(results_path, encoding="utf-8") as file:
        text = file.read()
    if arguments == ["--check"]:
        if not BLOCK.search(text) or written(record, text) != text:
            sys.exit("docs/results.md is not what docs/results.json says: run bench/record.py")
        print("docs/results.md: %d tables as docs/results.json has them" % len(BLOCK.findall(text)))
        return
    if arguments:
        record = merged(record, arguments)
        save(record, record_path)
    with open(results_path, "w", encoding="utf-8") as file:
        file.write(written(record, text))


if __name__ == "__main__":
    main()
