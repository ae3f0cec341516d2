"""Checks with `physical_validation` that the kinetic energy of particles in a bath has the distribution of the canonical ensemble.

    python bath.py STRIPMINE

Needs the package `physical_validation`; if it is not installed, the check prints SKIPPED and exits with 0.

Runs a Lennard-Jones fluid of 1120 particles, density 0.7, kT = 1, with each integrator. Samples are 5 units of time apart, so that they are
nearly independent with a drag of 1. Exits with 1 if the Kolmogorov–Smirnov p-value of the distribution is below 0.001.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

LEAST = 1e-3


def main(stripmine):
    try:
        import numpy
        import physical_validation
        from physical_validation.data import EnsembleData, ObservableData, SimulationData, SystemData, UnitData
    except ImportError as error:
        print(f"SKIPPED: {error}")
        return 0
    units = UnitData(
        kb=1.0,
        energy_str="epsilon",
        energy_conversion=1.0,
        length_str="sigma",
        length_conversion=1.0,
        volume_str="sigma^3",
        volume_conversion=1.0,
        temperature_str="epsilon",
        temperature_conversion=1.0,
        pressure_str="reduced",
        pressure_conversion=1.0,
        time_str="tau",
        time_conversion=1.0,
    )
    values = {}
    for integrator in ("baoab", "stochastic"):
        with tempfile.TemporaryDirectory() as folder:
            scene = {
                "integrator.kind": integrator,
                "integrator.dt": 0.002,
                "run.time": 1000,
                "run.thermo_every": 2500,
                "run.snapshot_every": 0,
            }
            settings = [part for key, value in scene.items() for part in ("--set", f"{key}={value}")]
            call = [stripmine, "run", "langevin-dense", "--quiet", "--threads", "1", "--overwrite", "--out", folder, *settings]
            subprocess.run(call, check=True)
            lines = (Path(folder) / "thermo.csv").read_text().splitlines()
        names = lines[0].split(",")
        rows = [dict(zip(names, map(float, line.split(",")))) for line in lines[1:]]
        kinetic = numpy.array([row["kinetic"] for row in rows if row["time"] > 50])
        particles = 1120
        # The package counts three degrees of freedom for each particle; a third is removed.
        system = SystemData(
            natoms=particles,
            nconstraints=particles,
            ndof_reduction_tra=0,
            ndof_reduction_rot=0,
            mass=numpy.ones(particles),
            molecule_idx=numpy.arange(particles),
            nconstraints_per_molecule=numpy.ones(particles),
        )
        data = SimulationData(
            units=units,
            ensemble=EnsembleData(ensemble="NVT", natoms=particles, volume=1.0, temperature=1.0),
            system=system,
            observables=ObservableData(kinetic_energy=kinetic, potential_energy=numpy.zeros_like(kinetic)),
        )
        values[integrator] = physical_validation.kinetic_energy.distribution(data, strict=True, verbosity=0)
    version = physical_validation.__version__
    for integrator, value in values.items():
        print(f"physical_validation {version}, {integrator}: p = {value:.3f}")
    return 0 if min(values.values()) > LEAST else 1


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1]))
