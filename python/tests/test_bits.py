"""Results are identical to the bit, whichever way they are requested."""

import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import stripmine

from . import scenes


def stride(scene):
    """Distance between two rows; a run has three."""
    return {"time": 2.0} if scene.method == "hard-disks" else {"steps": 20}


def state(simulation):
    """State of all particles as bytes."""
    particles = simulation.particles()
    return b"".join(
        array.tobytes()
        for array in (particles.id, particles.positions, particles.velocities, particles.angle, particles.angular_velocity)
    )


def rows(table):
    """The rows of a table, without the first column."""
    return np.stack([table[name] for name in table.columns[1:]], axis=1)


class Bits(unittest.TestCase):
    def test_advancing_in_pieces_changes_nothing(self):
        for name, overrides in scenes.SHORT.items():
            with self.subTest(name):
                scene = stripmine.scene(name, overrides)
                whole, pieces = scene.start(), scene.start()
                whole.advance(**{key: 3 * value for key, value in stride(scene).items()})
                for part in (0.5, 0, 1.5, 1):
                    pieces.advance(**{key: type(value)(part * value) for key, value in stride(scene).items()})
                    pieces.observe()
                self.assertEqual(state(whole), state(pieces))
                self.assertEqual(whole.observe(), pieces.observe())
                self.assertEqual((whole.time, whole.step, whole.events), (pieces.time, pieces.step, pieces.events))

    def compare_rows(self, thermo, found):
        """Compares rows with observations. Rates are since the previous row in the former, and since the start in the latter."""
        there, names = rows(thermo), thermo.columns[1:]
        for name in ("compressibility", "collision_rate"):
            if name in names:
                at, time = names.index(name), thermo["time"]
                since_start = np.cumsum(there[1:, at] * np.diff(time)) / (time[1:] - time[0])
                np.testing.assert_allclose(found[1:, at], since_start, rtol=1e-12)
                there[:, at] = found[:, at]
        np.testing.assert_array_equal(there, found)

    def test_observations_match_rows_of_runs(self):
        for name, overrides in scenes.SHORT.items():
            with self.subTest(name):
                scene = stripmine.scene(name, overrides)
                run, simulation = scene.run(), scene.start()
                found = [list(simulation.observe().values())]
                for _ in range(3):
                    simulation.advance(**stride(scene))
                    found.append(list(simulation.observe().values()))
                thermo = run.thermo()
                self.assertEqual(thermo.columns[1:], list(simulation.observe()))
                self.compare_rows(thermo, np.array(found))
                self.assertEqual(thermo["step"][-1], simulation.step or simulation.events)
                *_, last = run.frames()
                particles = simulation.particles()
                order, theirs = np.argsort(particles.id), np.argsort(last.particles.id)
                np.testing.assert_array_equal(particles.positions[order], last.particles.positions[theirs])
                np.testing.assert_array_equal(particles.velocities[order], last.particles.velocities[theirs])
                self.assertEqual((last.time, len(last.particles)), (simulation.time, len(particles)))

    @unittest.skipUnless(scenes.command(), "there is no command `stripmine`: set STRIPMINE, or the path")
    def test_runs_match_the_command(self):
        for name, overrides in scenes.SHORT.items():
            with self.subTest(name), tempfile.TemporaryDirectory() as folder:
                theirs, ours = Path(folder) / "theirs", Path(folder) / "ours"
                arguments = ["run", name, "--quiet", "--out", theirs, *scenes.flat(overrides)]
                subprocess.run([scenes.command(), *arguments], check=True, capture_output=True)
                run = stripmine.scene(name, overrides).run(ours)
                for file in ("thermo.csv", "trajectory.xyz", "scene.toml"):
                    self.assertEqual((theirs / file).read_bytes(), (ours / file).read_bytes(), file)
                read = stripmine.read(theirs)
                np.testing.assert_array_equal(rows(read.thermo()), rows(run.thermo()))
                self.assertEqual(read.toml(), stripmine.scene(name, overrides).toml())

    def test_resumed_runs_match_uninterrupted_runs(self):
        with tempfile.TemporaryDirectory() as folder:
            overrides = scenes.SHORT["dense-gas"]
            run = stripmine.scene("dense-gas", {**overrides, "run.steps": 40}).run(folder)
            self.assertEqual(len(run.thermo()), 3)
            stripmine.scene("dense-gas", overrides).run(folder, resume=True)
            whole = stripmine.scene("dense-gas", overrides).run()
            np.testing.assert_array_equal(rows(run.thermo()), rows(whole.thermo()))

    def test_arrays_set_particles_exactly(self):
        text = stripmine.scene("two-discs").toml()
        given = {
            "particles.positions": [[1.0 / 3.0, 1.0], [2.0, 1.0 + 1e-15]],
            "particles.velocities": np.array([[0.1, 0.0], [0.0, -1e-300]]),
        }
        particles = stripmine.scene(text, given).particles()
        np.testing.assert_array_equal(particles.positions, given["particles.positions"])
        np.testing.assert_array_equal(particles.velocities, given["particles.velocities"])

    def test_arrays_start_like_lists(self):
        # 1024 discs on a square lattice, as arrays and as lists that become text: the same scene to the bit.
        x, y = np.meshgrid(np.arange(32.0) + 1.0 / 3.0, np.arange(32.0) + 2.0 / 3.0)
        random = np.random.default_rng(5)
        arrays = {
            "domain.sides": np.array([32.0, 32.0]),
            "particles.generate": "list",
            "particles.positions": np.stack([x.ravel(), y.ravel()], axis=1),
            "particles.velocities": random.normal(size=(1024, 2)),
            "particles.radii": np.full(1024, 0.25),
            "particles.masses": random.uniform(1.0, 2.0, 1024),
            "particles.omegas": np.zeros(1024, dtype=int),
        }
        lists = {key: value if isinstance(value, str) else value.tolist() for key, value in arrays.items()}
        text = 'format = 2\nunits = "reduced"\n[method]\nkind = "hard-disks"\n[particles]\nradius = 0.25\nmass = 1.0\n[run]\ntime = 1.0\n'
        scenes_of = [stripmine.scene(text, given) for given in (arrays, lists)]
        self.assertEqual(scenes_of[0].toml(), scenes_of[1].toml())
        particles = scenes_of[0].particles()
        np.testing.assert_array_equal(particles.mass, arrays["particles.masses"])
        # Arrays in the order of columns, of single precision and of bodies.
        bodies = np.asfortranarray(random.normal(size=(5, 7)).astype(np.float32))
        bodies[:, 0] = 1.0
        scene = stripmine.scene("plummer", {"particles.generate": "list", "particles.bodies": bodies})
        np.testing.assert_array_equal(scene.particles().positions, bodies[:, 1:4].astype(float))


class Forces(unittest.TestCase):
    def test_pair_forces_match_accelerations(self):
        # Mass times the change of velocity in a short step; discs in contact, no gravity.
        scene = stripmine.scene("two-discs")
        simulation = scene.start()
        while not np.any(simulation.forces()):
            simulation.advance(steps=1)
            self.assertLess(simulation.time, 10.0)
        simulation.advance(steps=20)
        before, force = simulation.particles(), simulation.forces()
        time = simulation.time
        simulation.advance(steps=1)
        found = before.mass[:, None] * (simulation.particles().velocities - before.velocities) / (simulation.time - time)
        np.testing.assert_allclose(force.sum(axis=0), 0, atol=1e-9 * np.abs(force).max())
        np.testing.assert_allclose(found, force, rtol=0.05, atol=1e-3 * np.abs(force).max())

    def test_methods_without_pair_forces_raise(self):
        for name in ("hard-disks", "cold-collapse"):
            simulation = stripmine.scene(name, scenes.SHORT[name]).start()
            with self.assertRaisesRegex(stripmine.Error, "no continuous pair forces"):
                simulation.forces()
        free = stripmine.scene("langevin-free", {"particles.count": 10}).start()
        np.testing.assert_array_equal(free.forces(), np.zeros((10, 2)))


if __name__ == "__main__":
    unittest.main()
