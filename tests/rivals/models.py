#!/usr/bin/env python3
"""Predicts the loops of a chained step with llvm-mca and OSACA, and measures the step and the peaks of this processor. Optional: no test needs it.

    CARGO_PROFILE_RELEASE_STRIP=none RUSTFLAGS="-C symbol-mangling-version=v0" cargo build --release
    apt-get install llvm-19 binutils-riscv64-linux-gnu      (Debian; nothing is installed by the script)
    python3 -m venv FOLDER && FOLDER/bin/pip install osaca
    python3 tests/rivals/models.py --osaca FOLDER/bin/osaca [--out FOLDER]

The step is that of the granular bench, chained, in f64. Its programs are found by their symbols. `trace.c` records the instructions that each
executes, in order; a strip is the part between two visits of the head of the loop. So branches on options are taken as they are, and a loop over
the mask is unrolled. llvm-mca predicts the whole strip. OSACA predicts a loop inside of the strip once, times its passes, plus the rest:
it needs minutes for thousands of instructions. Its prediction is the larger of port pressure and loop-carried dependencies. Neither knows caches.

`validate-model --calibrate` measures the phases of the step, beside the prediction of our host model. `peaks.c` measures the peaks for a roofline.
For the RISC-V text llvm-mca predicts each section on a SiFive X280 with groups of four registers.
"""

import argparse
import collections
import csv
import functools
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

from environment import said
from provenance import provenance, refusal, write

HERE = pathlib.Path(__file__).parent
# Programs of the step by part, with the type of their kernel.
KERNELS = [
    ("predictor", r"GearPredictor<f64, f64, 5, 3>"),
    ("index", r"ClearIndex"),
    ("index", r"EnterDiscs<f64, f64>"),
    ("index", r"CheckIndex"),
    ("index", r"IndexImages"),
    ("lattice", r"SpreadToLattice<f64>"),
    ("forces", r"Forces<f64, [\w:]*Granular<true, true>>"),
    ("corrector", r"GearCorrector<f64, f64, 5, 3>"),
]
PARTICLES = [560, 9500]
OCCUPANCY = 0.168
# Instructions of a program that are recorded: several strips of the forces.
RECORDED = 20_000
# Longest strip that OSACA is given as a whole.
WHOLE = 600
MCA = "llvm-mca-19"
LEAVE = re.compile(r"(j\w+|call)\b")


def run(call, **more):
    done = subprocess.run([str(part) for part in call], capture_output=True, text=True, timeout=1200, **more)
    if done.returncode != 0:
        raise SystemExit(f"{call[0]}: {said(done.stderr or done.stdout)}")
    return done


def functions(program, vectors):
    """Address and size of the chained function of each kernel, for one set of vector registers."""
    listed = run(["nm", "-SC", program]).stdout.splitlines()
    chained = [line for line in listed if "ChainedRun" in line and f"{vectors}>::vectorize::imp" in line]
    if not chained:
        raise SystemExit(f"{program} has no symbols of loops: build it as the head of this script says")
    found = []
    for part, kernel in KERNELS:
        lines = [line for line in chained if re.search(rf"ChainedRun<[\w:]*{kernel}>", line)]
        if len(lines) != 1:
            raise SystemExit(f"{len(lines)} functions of {kernel} in {program}")
        address, size = lines[0].split()[:2]
        found.append((part, kernel, int(address, 16), int(size, 16)))
    return found


def scene(particles):
    packing = OCCUPANCY * 3.141592653589793
    keys = {"particles.count": particles, "particles.packing_fraction": packing, "machine.execution": "chained"}
    keys.update({"search.by": "lattice", "search.cell_edge": 0.5})
    return ["bench", *(word for key, value in keys.items() for word in ("--set", f"{key}={value}"))]


def passes(offsets):
    """Splits a sequence at every visit of the first offset that is visited often: before, the passes, after."""
    counted = collections.Counter(offsets)
    head = next((offset for offset in offsets if counted[offset] >= 4), None)
    if head is None:
        return offsets, [], []
    at = [place for place, offset in enumerate(offsets) if offset == head]
    # The last pass ends where its longest predecessor would.
    longest = max(end - start for start, end in zip(at, at[1:]))
    end = min(len(offsets), at[-1] + longest)
    return offsets[: at[0]], [offsets[start:stop] for start, stop in zip(at, at[1:] + [end])], offsets[end:]


def middle(of):
    """A pass of median length, without the last, which may be cut off."""
    return sorted(of[:-1] or of, key=len)[len(of[:-1] or of) // 2]


class Code:
    """Text of the instructions of a function."""

    def __init__(self, program, address, size):
        listed = run(["objdump", "-d", "--no-show-raw-insn", f"--start-address={address}", f"--stop-address={address + size}", program]).stdout
        self.lines = {}
        for line in listed.splitlines():
            matched = re.match(r"\s+([0-9a-f]+):\t(.*)", line)
            if matched:
                text = matched[2].split("#")[0].split("<")[0].strip()
                self.lines[int(matched[1], 16) - address] = f"{text.split()[0]} .Lelsewhere" if LEAVE.match(text) and "*" not in text else text

    def text(self, offsets):
        return "\n".join(self.lines[offset] for offset in offsets) + "\n"


def mca(text, words):
    """Clock periods of a pass in the steady state, and the instructions that are not known."""
    def asked(iterations):
        call = [MCA, *words, f"-iterations={iterations}", "-skip-unsupported-instructions=any", "-all-views=false", "-summary-view"]
        done = run(call, input=text)
        return int(re.search(r"Total Cycles:\s+(\d+)", done.stdout)[1]), done.stderr
    few, many = asked(10), asked(30)
    unknown = re.findall(r"(?:warning|error):.*\n(.*)", many[1])
    return (many[0] - few[0]) / 20, forms(unknown)


def forms(lines):
    """Mnemonics with their numbers."""
    return dict(collections.Counter(line.split()[0] for line in lines if line.strip()))


def shape(line):
    """Form of an instruction: its mnemonic and the kinds of its operands."""
    return re.sub(r"[-\w]*\([^)]*\)", "m", re.sub(r"\$[-\w]+", "i", re.sub(r"%([a-z]*)\w*", r"\1", line)))


def analysed(program, text, folder):
    """Result of OSACA as text; none if it fails."""
    source, result = folder / "loop.s", folder / "loop.yml"
    source.write_text(text)
    call = [program, "--arch", "ZEN4", "--lcd-timeout", 30, "--ignore-unknown", "--yaml-out", result, "--out", folder / "loop.txt", source]
    done = subprocess.run([str(word) for word in call], capture_output=True, text=True, timeout=1200)
    return result.read_text() if done.returncode == 0 else None


@functools.cache
def fails(program, line, folder):
    """True if OSACA fails on an instruction alone."""
    return analysed(program, line + "\n", folder) is None


def osaca(program, text, folder):
    """Clock periods of a pass, and the instructions that are not known. Those that OSACA 0.7.1 fails on ("Port '135' not in port list") count as
    not known."""
    dropped, found = [], analysed(program, text, folder)
    if found is None:
        lines = text.splitlines()
        first = {shape(line): line for line in reversed(lines)}
        dropped = [line for line in lines if fails(program, first[shape(line)], folder)]
        found = analysed(program, "\n".join(line for line in lines if line not in dropped) + "\n", folder)
    kernel, summary = found.split("\nSummary:\n")
    unknown = list(dropped)
    for entry in kernel.split("\n- Comment:")[1:]:
        flags, line = re.search(r"Flags: \[(.*?)\]", entry, re.DOTALL), re.search(r"\n  Line: '?(.*)", entry)
        if flags and "tp_unknown" in flags[1]:
            unknown.append(line[1])
    pressure = [float(value) for value in re.findall(r":\s+([\d.]+)[,}]", summary[summary.index("PortPressure") :].split("\nTarget")[0])]
    dependency = float(re.search(r"LCD: ([\d.]+)", summary)[1])
    return max(*pressure, dependency), forms(unknown)


def osaca_strip(program, code, offsets, folder):
    """As `osaca`, with an inner loop predicted once."""
    if len(offsets) <= WHOLE:
        return osaca(program, code.text(offsets), folder)
    before, inner, after = passes(offsets[1:])
    (loop, unknown), (rest, others) = (osaca(program, code.text(of), folder) for of in (middle(inner), offsets[:1] + before + after))
    counted = collections.Counter(others)
    for form, count in unknown.items():
        counted[form] += count * len(inner)
    return len(inner) * loop + rest, dict(counted)


def loops(asked, vectors, folder):
    """Predictions for a strip of every program."""
    tracer = folder / "trace"
    run(["cc", "-O2", HERE / "trace.c", "-o", tracer])
    found = functions(asked.stripmine, vectors)
    words = [f"{address:x}:{size:x}" for *_, address, size in found]
    call = [tracer, RECORDED, *words, "--", asked.stripmine, "run", *scene(PARTICLES[0]), "--set", "run.steps=6", "--threads", 1]
    lines = [line.split() for line in run([*call, "--quiet", "--overwrite", "--out", folder / "run"]).stdout.splitlines()]
    traced = {int(words[0], 16): [int(word, 16) for word in words[1:]] for words in lines}
    rows = []
    for part, kernel, address, size in found:
        code = Code(asked.stripmine, address, size)
        strip = middle(passes(traced[address])[1])
        text = code.text(strip)
        periods, unknown = mca(text, ["-mcpu=znver4"])
        row = {"part": part, "kernel": kernel.split("<")[0], "instructions": len(strip)}
        row["branches"] = sum(1 for offset in strip if LEAVE.match(code.lines[offset]))
        row["mca"], row["mca_unknown"] = periods, unknown
        row["osaca"], row["osaca_unknown"] = osaca_strip(asked.osaca, code, strip, folder)
        print(row, file=sys.stderr, flush=True)
        rows.append(row)
    return rows


def riscv(asked, folder):
    """Clock periods of every section of the RISC-V text, by llvm-mca on a SiFive X280."""
    emitted = folder / "emitted"
    run([asked.stripmine, "emit", *scene(PARTICLES[0]), "--isa", "rvv", "--lmul", 4, "--quiet", "--out", emitted])
    texts, program, section = {}, None, None
    for line in (emitted / "kernels.S").read_text().splitlines():
        if matched := re.match(r"(\w+):$", line):
            program, section = matched[1], None
        elif matched := re.match(r"# (.*)$", line):
            section = matched[1]
        elif program and section and line.startswith("    "):
            code = line.split("#")[0].strip()
            if code.split()[0] not in ("bne", "jalr"):
                texts.setdefault((program, section), []).append(code)
    rows = []
    for (program, section), lines in texts.items():
        text = "\n".join(["vsetvli t0, a0, e64, m4, ta, mu", *lines]) + "\n"
        periods, unknown = mca(text, ["-mtriple=riscv64", "-mcpu=sifive-x280", "-mattr=+v,+d"])
        rows.append({"program": program, "section": section, "instructions": len(lines), "mca": periods, "unknown": unknown})
    return rows


def measured(asked, folder):
    """Measured phases with the prediction of our host model (ns)."""
    call = [asked.stripmine, "validate-model", "--calibrate", "--particles", ",".join(map(str, PARTICLES)), "--occupancies", OCCUPANCY]
    run([*call, "--seconds", asked.seconds, "--threads", 1, "--quiet", "--out", folder / "validation"])
    rows = []
    with open(next((folder / "validation").rglob("cases.csv"))) as file:
        for line in csv.DictReader(file):
            matched = re.match(r"f64, NP = (\d+), ", line["place"])
            if matched:
                rows.append({
                    "particles": int(matched[1]), "execution": line["execution"], "phase": line["phase"],
                    "host": float(line["predicted"]), "measured": float(line["measured"]),
                })
    return rows


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--stripmine", type=pathlib.Path, default=pathlib.Path("target/release/stripmine"))
    parser.add_argument("--osaca", default="osaca", help="the program of OSACA")
    parser.add_argument("--seconds", type=int, default=120, help="of the measurement of the step")
    parser.add_argument("--out", type=pathlib.Path, help="folder for models.json")
    asked = parser.parse_args()
    refused = refusal(asked.out, asked.stripmine)
    if refused is not None:
        return refused
    missing = [tool for tool in (MCA, asked.osaca, "objdump", "nm", "cc") if not shutil.which(tool)]
    flags = pathlib.Path("/proc/cpuinfo").read_text() if pathlib.Path("/proc/cpuinfo").exists() else ""
    if missing or "avx512f" not in flags:
        print(f"skipped: {', '.join(missing) or 'a processor with AVX-512'} is missing")
        return 0
    # The commit at the start.
    provenance()
    asked.stripmine = asked.stripmine.resolve()
    if hasattr(os, "sched_setaffinity"):
        # Child processes inherit the core.
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    with tempfile.TemporaryDirectory(prefix="stripmine-models-") as folder:
        folder = pathlib.Path(folder)
        peaks = folder / "peaks"
        run(["cc", "-O2", "-march=native", "-ffp-contract=off", HERE / "peaks.c", "-o", peaks])
        before = json.loads(run([peaks]).stdout)
        steps = measured(asked, folder)
        after = json.loads(run([peaks]).stdout)
        processor = after
        processor["ghz"] = statistics.fmean([before["ghz"], after["ghz"]])
        versions = [re.search(r"LLVM version (\S+)", run([MCA, "--version"]).stdout)[1], run([asked.osaca, "--version"]).stdout.split()[-1]]
        found = {
            "llvm": versions[0], "osaca": versions[1], "occupancy": OCCUPANCY, "lanes": 8, "processor": processor,
            "steps": steps, "loops": loops(asked, "v4::V4", folder), "sections": riscv(asked, folder),
        }
    text = json.dumps(found, indent=1) + "\n"
    if asked.out:
        write(asked.out, {"models.json": text})
    else:
        print(text)
    return 0


if __name__ == "__main__":
    sys.exit(main())
