"""The numbers of `octalux-bench ... --quick --json` against those in bench_quick.json.

    check_bench.py TABLE.json FOUND.json...            compare; every quality that was found must be in the table, and close
    check_bench.py --update TABLE.json FOUND.json...   put what was found in the table, with the tolerances below

Qualities are deterministic, but for rays that Embree casts with other instructions on other machines: a few of them take
another texel or miss an edge. Tolerances are what that may change, stated for each row: a share of the value, and no less
than a step that depends on the column.
"""
import json
import sys

SHARE = 0.03
STEPS = {"share": 0.002, "ssim": 0.01, "flip": 0.004, "relative_mse": 2e-4}  # by unit or end of key; none for others
COLUMNS = ("experiment", "table", "row", "column", "value", "tolerance")


def experiments(paths):
    for path in paths:
        found = json.load(open(path))
        yield from found.get("experiments", [found])


def qualities(experiment):
    """(table, row, column, value, step) of every quality."""
    for table in experiment["tables"]:
        names = [c["key"] for c in table["columns"] if c["kind"] == "name"]
        seen = set()
        for row in table["rows"]:
            name = " / ".join(row[key] for key in names)
            assert name not in seen, f"{experiment['experiment']}: two rows are called {name}"
            seen.add(name)
            for column in table["columns"]:
                value = row[column["key"]]
                if column["kind"] == "quality" and value is not None:
                    yield table["name"], name, column, value


def step_of(column):
    ends = [step for end, step in STEPS.items() if column["key"].endswith(end) or column.get("unit") == end]
    return max(ends, default=0)


def update(path, found):
    kept = [row for row in json.load(open(path))["rows"]] if found["merge"] else []
    names = {experiment["experiment"] for experiment in found["experiments"]}
    rows = [row for row in kept if row[0] not in names]
    for experiment in found["experiments"]:
        for table, name, column, value in qualities(experiment):
            tolerance = max(SHARE * abs(value), step_of(column))
            rows.append([experiment["experiment"], table, name, column["key"], float(f"{value:.6g}"), float(f"{tolerance:.2g}")])
    with open(path, "w", encoding="utf-8") as file:
        file.write('{"columns": %s,\n "rows": [\n' % json.dumps(COLUMNS))
        file.write(",\n".join("  " + json.dumps(row, ensure_ascii=False) for row in rows))
        file.write("\n]}\n")
    print(f"{len(rows)} rows")


def compare(path, found):
    table = {tuple(row[:4]): row[4:] for row in json.load(open(path))["rows"]}
    faults, count = [], 0
    for experiment in found:
        own = {key for key in table if key[0] == experiment["experiment"]}
        for where, name, column, value in qualities(experiment):
            key = (experiment["experiment"], where, name, column["key"])
            text = ", ".join(key)
            if key not in table:
                faults.append(f"{text}: {value:.6g} is not in the table")
                continue
            own.discard(key)
            wanted, tolerance = table[key]
            count += 1
            if not abs(value - wanted) <= tolerance:
                faults.append(f"{text}: {value:.6g} is not {wanted:.6g} \u00b1 {tolerance:.2g}")
        faults += [f"{', '.join(key)}: was not found" for key in sorted(own)]
    for fault in faults:
        print(fault)
    print(f"{count} numbers compared, {len(faults)} faults")
    return 1 if faults or not count else 0


def main():
    if sys.argv[1] == "--update":
        return update(sys.argv[2], {"merge": len(list(experiments(sys.argv[3:]))) == 1, "experiments": list(experiments(sys.argv[3:]))})
    return compare(sys.argv[1], list(experiments(sys.argv[2:])))


if __name__ == "__main__":
    sys.exit(main())
