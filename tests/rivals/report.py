"""Output of all scripts for the report: contests.json, with its provenance.

A contest has the system, its particles, our configuration, and the rates of every round of ours and of the rival, in `unit`. `same` lists
numbers that must agree: name, ours, theirs, and the largest difference.
"""

import json
import statistics

import provenance


def contest(system, particles, configuration, ours, theirs):
    ratios = [own / other for own, other in zip(ours, theirs)]
    return {"system": system, "particles": particles, "configuration": configuration, "ours": ours, "theirs": theirs, "ratios": ratios}


def same(what, ours, theirs, within):
    return {"what": what, "ours": ours, "theirs": theirs, "within": within}


def result(rival, version, build, instruction_set, unit, contests, agreement):
    return {
        "rival": rival, "version": str(version), "build": build, "instruction_set": instruction_set, "unit": unit,
        "contests": contests, "same": agreement,
    }


def shown(found):
    """Returns a line for each contest and each check of agreement."""
    lines = [f"{found['rival']} {found['version']} ({found['build']}); {found['unit']}"]
    for it in found["contests"]:
        ours, theirs, ratio = (statistics.median(it[key]) for key in ("ours", "theirs", "ratios"))
        lines.append(f"{it['system']}, {it['particles']}, {it['configuration']}: {ours:.3g} against {theirs:.3g}, ratio {ratio:.2f}")
    lines += [f"{it['what']}: {it['ours']:.6g} and {it['theirs']:.6g} (within {it['within']:.2g})" for it in found["same"]]
    return "\n".join(lines)


def write(folder, found):
    provenance.write(folder, {"contests.json": json.dumps(found, indent=1) + "\n"})
