"""Particles of one's own, as arrays and as files of other programs: the same numbers to the bit, in runs and copies too."""

import pickle
import shutil
import struct
import tempfile
import tracemalloc
import unittest
from pathlib import Path

import numpy as np

import stripmine

# One configuration of 16 discs by several programs; beside these tests, or in the checkout.
FILES = [Path(__file__).with_name("start_files"), Path(__file__).parents[2] / "tests" / "io" / "start_files"]
FILES = next((folder for folder in FILES if folder.is_dir()), None)
DISCS = 'format = 2\nunits = "reduced"\n[method]\nkind = "hard-disks"\n[run]\ntime = 2.0\nthermo_every = 0.5\nsnapshot_every = 1.0\n'
LARGE = 300


class Numbers(np.ndarray):
    """An array that can be copied as numbers, but neither listed nor printed."""

    def refuse(self, *_):
        raise AssertionError("the array was made a list or a text")

    tolist = __iter__ = __getitem__ = __repr__ = __str__ = __format__ = refuse


def jittered(side, seed):
    """Centres of side² discs of radius 0.25 that do not overlap, in a box of side × side."""
    x, y = np.meshgrid(np.arange(side) + 0.5, np.arange(side) + 0.5)
    return np.stack([x.ravel(), y.ravel()], axis=1) + np.random.default_rng(seed).uniform(-0.2, 0.2, (side * side, 2))


def of_arrays(side):
    """Overrides for discs of `DISCS` with random positions and velocities."""
    return {
        "domain.sides": [float(side), float(side)],
        "particles.generate": "list",
        "particles.radius": 0.25,
        "particles.mass": 1.0,
        "particles.positions": jittered(side, 1),
        "particles.velocities": np.random.default_rng(2).normal(size=(side * side, 2)),
    }


def gsd_chunks(path):
    """Arrays of the first frame of a GSD file by their names, read as the specification of the format says."""
    data = path.read_bytes()
    _, index, entries, names, blocks = struct.unpack_from("<5Q", data)
    names = [name.decode() for name in data[names : names + 64 * blocks].split(b"\0") if name]
    types = {1: "u1", 3: "<u4", 5: "i1", 7: "<i4", 9: "<f4", 10: "<f8"}
    found = {}
    for entry in range(entries):
        frame, rows, location, columns, name, kind, _ = struct.unpack_from("<QQqIHBB", data, index + 32 * entry)
        if location and frame == 0:
            found[names[name]] = np.frombuffer(data, types[kind], rows * columns, location).reshape(rows, columns)
    return found


class Arrays(unittest.TestCase):
    def test_large_arrays_stay_numbers(self):
        given = of_arrays(LARGE)
        arrays = {key: value for key, value in given.items() if isinstance(value, np.ndarray)}
        size = sum(array.nbytes for array in arrays.values())
        given |= {key: array.view(Numbers) for key, array in arrays.items()}
        tracemalloc.start()
        try:
            scene = stripmine.scene(DISCS, given)
            _, peak = tracemalloc.get_traced_memory()
        finally:
            tracemalloc.stop()
        # Lists of the numbers would take more than four times the memory of all arrays.
        self.assertLess(peak, 2 * size)
        particles = scene.particles()
        self.assertEqual(len(particles), LARGE * LARGE)
        self.assertEqual(particles.positions.tobytes(), arrays["particles.positions"].tobytes())
        self.assertEqual(particles.velocities.tobytes(), arrays["particles.velocities"].tobytes())

    def test_runs_of_arrays_resume_and_pickle(self):
        scene = stripmine.scene(DISCS, of_arrays(12))
        again = pickle.loads(pickle.dumps(scene))
        with tempfile.TemporaryDirectory() as folder:
            whole, pieces = Path(folder, "whole"), Path(folder, "pieces")
            scene.run(whole)
            simulation = scene.start(pieces)
            simulation.advance(time=0.75)
            simulation.save()
            del simulation
            # By a copy of the scene, by its arrays, and by the text in the folder.
            again.start(pieces, resume=True).save()
            stripmine.scene(DISCS, of_arrays(12)).start(pieces, resume=True).save()
            run = stripmine.scene(pieces / "scene.toml").run(pieces, resume=True)
            for name in ("thermo.csv", "trajectory.xyz", "scene.toml"):
                self.assertEqual((whole / name).read_bytes(), (pieces / name).read_bytes(), name)
            first = next(iter(pickle.loads(pickle.dumps(run)).frames())).particles
            self.assertEqual(first.positions.tobytes(), of_arrays(12)["particles.positions"].tobytes())


@unittest.skipUnless(FILES, "the start files of the checkout are not here")
class StartFiles(unittest.TestCase):
    def started(self, name, **keys):
        return stripmine.scene(DISCS, {"particles": {"file": FILES / name, **keys}})

    def test_files_of_others_have_their_bits(self):
        for name, head, columns, keys in (
            ("base.xyz", 2, ([1, 2], [5, 6]), {}),
            ("ovito_student.xyz", 2, ([1, 2], [4, 5]), {"mass": 2.0}),
            ("lammps.data", 11, ([4, 5], None), {"temperature": 0.0}),
        ):
            with self.subTest(name):
                rows = [line.split() for line in (FILES / name).read_text().splitlines()[head : head + 16]]
                places, velocities = (None if at is None else np.array([[float(row[it]) for it in at] for row in rows]) for at in columns)
                particles = self.started(name, **keys).particles()
                np.testing.assert_array_equal(particles.positions, places)
                np.testing.assert_array_equal(particles.velocities, np.zeros((16, 2)) if velocities is None else velocities)
                np.testing.assert_array_equal(particles.radius, np.full(16, 0.5))

    def test_gsd_has_its_single_precision_numbers(self):
        chunks = gsd_chunks(FILES / "start.gsd")
        particles = self.started("start.gsd", radius=0.25, mass=3.0).particles()
        # Positions are from the centre of the box of 20 × 20.
        np.testing.assert_array_equal(particles.positions, chunks["particles/position"][:, :2].astype(float) + 10.0)
        np.testing.assert_array_equal(particles.velocities, chunks["particles/velocity"][:, :2].astype(float))
        self.assertEqual((set(particles.radius), set(particles.mass)), ({0.25}, {3.0}))

    def test_arrays_and_files_start_alike(self):
        of_file = self.started("base.xyz").particles()
        given = {"positions": of_file.positions, "velocities": of_file.velocities, "radii": of_file.radius, "masses": of_file.mass}
        keys = {"domain.sides": [20.0, 20.0], "particles": {"generate": "list", "radius": 0.5, "mass": 1.0, **given}}
        simulations = [stripmine.scene(DISCS, keys).start(), self.started("base.xyz").start()]
        for simulation in simulations:
            simulation.advance(time=5.0)
        ours, theirs = (it.particles() for it in simulations)
        np.testing.assert_array_equal(ours.positions, theirs.positions)
        np.testing.assert_array_equal(ours.velocities, theirs.velocities)

    def test_moved_files_resume_and_pickle(self):
        with tempfile.TemporaryDirectory() as folder:
            before, after = Path(folder, "before"), Path(folder, "after")
            before.mkdir()
            shutil.copy(FILES / "base.xyz", before)
            (before / "discs.toml").write_text(DISCS + '[particles]\nfile = "base.xyz"\n')
            scene = stripmine.scene(before / "discs.toml")
            scene.run(before / "whole")
            np.testing.assert_array_equal(pickle.loads(pickle.dumps(scene)).particles().positions, scene.particles().positions)
            simulation = scene.start(before / "discs.run")
            simulation.advance(time=0.75)
            simulation.save()
            del simulation
            rows = (before / "whole" / "thermo.csv").read_bytes()
            before.rename(after)
            run = stripmine.scene(after / "discs.toml").run(after / "discs.run", resume=True)
            self.assertEqual((Path(run.folder) / "thermo.csv").read_bytes(), rows)
            # Another file is refused.
            text = (after / "base.xyz").read_text()
            (after / "base.xyz").write_text(text.replace("1.288838", "1.288839"))
            with self.assertRaisesRegex(stripmine.RunError, "base.xyz"):
                stripmine.scene(after / "discs.toml").run(after / "discs.run", resume=True)


if __name__ == "__main__":
    unittest.main()
