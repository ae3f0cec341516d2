"""Reads every table of a report with pandas, as its data packages describe them.

    python report_tables.py REPORT_FOLDER

Each folder with a `datapackage.json` (Frictionless) names its files and their columns: each table must have exactly these columns, with the described
types, and every file must be described. Without pandas the check prints SKIPPED and exits with 0. Exits with 1 if a table differs from its
description.
"""

import json
import sys
from pathlib import Path


def complaints_of(folder, pandas):
    """Yields the mistakes in the tables of a folder."""
    package = json.loads((folder / "datapackage.json").read_text())
    described = set()
    for resource in package["resources"]:
        file = folder / resource["path"]
        described.add(file.name)
        table = pandas.read_csv(file)
        fields = resource["schema"]["fields"]
        names = [field["name"] for field in fields]
        if list(table.columns) != names:
            yield f"{file}: columns {list(table.columns)} instead of {names}"
            continue
        for field in fields:
            is_number = pandas.api.types.is_numeric_dtype(table[field["name"]])
            is_empty = table[field["name"]].isna().all()
            if not is_empty and is_number != (field["type"] != "string"):
                yield f"{file}: {field['name']} is read as {table[field['name']].dtype}, described as {field['type']}"
    for file in sorted(folder.glob("*.csv")):
        if file.name not in described:
            yield f"{file} is not described"


def main():
    if len(sys.argv) != 2 or not Path(sys.argv[1]).is_dir():
        print("usage: report_tables.py REPORT_FOLDER", file=sys.stderr)
        sys.exit(2)
    try:
        import pandas
    except ImportError:
        print("SKIPPED (no pandas)")
        return
    folders = sorted(path.parent for path in Path(sys.argv[1]).rglob("datapackage.json"))
    complaints = [complaint for folder in folders for complaint in complaints_of(folder, pandas)]
    for complaint in complaints:
        print(f"FAILED: {complaint}")
    print(f"{len(folders)} data packages: {'OK' if not complaints else f'{len(complaints)} FAILED'}")
    sys.exit(1 if complaints or not folders else 0)


if __name__ == "__main__":
    main()
