"""The results of contests as Markdown, CSV and JSON."""

import csv
import io
import json
import statistics

import provenance

COLUMNS = [
    "packing fraction", "discs", "way", "ours (10⁶/s)", "LAMMPS (10⁶/s)", "ratio", "kT ours", "kT LAMMPS", "contacts ours",
    "contacts LAMMPS", "ns a disc and step",
]


def with_range(values):
    return f"{statistics.median(values):.2f} ({min(values):.2f} to {max(values):.2f})"


def rows(contest):
    """A row of words for each of our ways."""
    rival = contest["lammps"]
    for entry in contest["ours"]:
        head = [f"{contest['packing_fraction']:.2f}", str(contest["particles"])]
        way = f"{entry['what']} {entry['precision']} {entry['integrator']}"
        if "refused" in entry:
            yield head + [way, "–", with_range(rival["rates"]), f"refused: {entry['refused']}"] + [""] * 5
            continue
        phases = ", ".join(f"{phase} {each:.1f}" for phase, each in entry["nanoseconds"].items())
        yield head + [
            way, with_range(entry["rates"]), with_range(rival["rates"]), with_range(entry["ratios"]),
            f"{entry['temperature']:.6f}", f"{rival['temperature']:.6f}", f"{entry['contacts']:.4f}",
            f"{rival['contacts']:.4f}", phases,
        ]


def markdown(contests):
    lines = ["| " + " | ".join(COLUMNS) + " |", "|" + "---|" * len(COLUMNS)]
    lines += ["| " + " | ".join(row) + " |" for contest in contests for row in rows(contest)]
    head = ["packing fraction", "discs", "steps", "rounds", "farthest apart", "farthest moved", "skin", "lists made", "too late"]
    lines += ["", "| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for contest in contests:
        rival = contest["lammps"]
        cells = [
            f"{contest['packing_fraction']:.2f}", contest["particles"], contest["steps"], contest["rounds"],
            *("–" if contest[way] is None else f"{contest[way]:.1e}" for way in ("apart", "moved")),
            rival["skin"], int(rival["list_builds"]), int(rival["dangerous_builds"]),
        ]
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    version = sorted({contest["lammps"]["version"] for contest in contests})
    sets = sorted({entry["instruction_set"] for c in contests for entry in c["ours"] if "instruction_set" in entry})
    lines += ["", f"Processor time of one thread. Ours on {', '.join(sets)}; LAMMPS {', '.join(map(str, version))}."]
    return "\n".join(lines) + "\n"


def table(contests):
    """The figures as CSV, a line for each round."""
    text = io.StringIO()
    out = csv.writer(text, lineterminator="\n")
    out.writerow([
        "packing_fraction", "particles", "steps", "what", "precision", "integrator", "round", "ours_million_per_second",
        "lammps_million_per_second", "ratio", "ours_temperature", "lammps_temperature", "ours_contacts", "lammps_contacts",
    ])
    for contest in contests:
        rival = contest["lammps"]
        for entry in (entry for entry in contest["ours"] if "refused" not in entry):
            for number, (own, theirs, ratio) in enumerate(zip(entry["rates"], rival["rates"], entry["ratios"]), 1):
                out.writerow([
                    contest["packing_fraction"], contest["particles"], contest["steps"], entry["what"], entry["precision"],
                    entry["integrator"], number, own, theirs, ratio, entry["temperature"], rival["temperature"],
                    entry["contacts"], rival["contacts"],
                ])
    return text.getvalue()


def write(contests, folder):
    """Writes all three into a folder, if there is one; gives the Markdown."""
    text = markdown(contests)
    if folder:
        files = {"md": text, "csv": table(contests), "json": json.dumps(contests, indent=1) + "\n"}
        provenance.write(folder, {f"lammps.{kind}": contents for kind, contents in files.items()})
    return text
