"""Changes during a simulation, compared with exact motion; recorded, saved and restored simulations; comparisons and pictures by the command."""

import math
import tempfile
import unittest
from pathlib import Path

import numpy as np
import stripmine

from . import scenes

COMMAND = unittest.skipUnless(scenes.command(), "there is no command `stripmine`: set STRIPMINE, or the path")
# Steps of 2⁻⁷: free flight and fall have no rounding.
EXACT = {
    "integrator.kind": "velocity-verlet",
    "integrator.dt": 2.0**-7,
    "law.stiffness": 1.0,
    "law.normal_damping": 0.0,
    "law.shear_damping": 0.0,
}
SHORT = {"run.steps": 400, "run.thermo_every": 20, "run.snapshot_every": 50, "run.checkpoint_every": 100}


def state(simulation):
    """State of all particles as bytes."""
    particles = simulation.particles()
    return b"".join(array.tobytes() for array in (particles.positions, particles.velocities, particles.angular_velocity))


class Steering(unittest.TestCase):
    def test_discs_fly_and_fall_exactly(self):
        simulation = stripmine.scene("two-discs", EXACT).start()
        start = simulation.particles().positions
        velocities = np.array([[0.5, -0.25], [-0.125, 1.0]])
        simulation.set(velocities=velocities)
        simulation.advance(steps=128)
        np.testing.assert_array_equal(simulation.particles().positions, start + velocities)
        # A list, and an array with another order in memory.
        simulation.set(gravity=[0.25, -2.0], velocities=np.asfortranarray(2 * velocities))
        simulation.advance(steps=64)
        particles = simulation.particles()
        np.testing.assert_array_equal(particles.positions, start + 2 * velocities + [0.03125, -0.25])
        np.testing.assert_array_equal(particles.velocities, 2 * velocities + [0.125, -1.0])
        self.assertLess(abs(simulation.observe()["balance_error"]), 1e-13)

    def test_spins_can_be_set(self):
        simulation = stripmine.scene("two-discs").start()
        simulation.set(angular_velocities=[2.0, -1.0])
        simulation.advance(time=0.25)
        # Before the collision nothing changes them.
        np.testing.assert_allclose(simulation.particles().angular_velocity, [2.0, -1.0], rtol=1e-12)
        np.testing.assert_allclose(simulation.particles().angle, [0.5, -0.25], rtol=1e-12)

    def test_walls_move_on_with_another_velocity(self):
        simulation = stripmine.scene("shear-cell", {"integrator.dt": 2.0**-10}).start()
        simulation.advance(time=0.5)
        simulation.set(wall_velocities=[[0.25, 0.0], [0.5, 0.0]])
        simulation.advance(time=1.0)
        seen = simulation.observe()
        # Middles of walls 20 long that moved by -0.5 and 0.5 before.
        self.assertAlmostEqual(seen["wall_1_x"], 10.0 - 0.5 + 0.25, places=12)
        self.assertAlmostEqual(seen["wall_2_x"], 10.0 + 0.5 + 0.5, places=12)
        self.assertEqual((seen["wall_1_velocity_x"], seen["wall_2_velocity_x"]), (0.25, 0.5))

    def test_temperature_relaxes_to_the_bath(self):
        scene = stripmine.scene("langevin-free", {"particles.count": 20000, "domain.sides": [500.0, 500.0], "integrator.dt": 0.05})
        simulation = scene.start()
        simulation.set(bath_temperature=3.0)
        for time in (0.25, 0.5, 1.0):
            simulation.advance(time=time - simulation.time)
            # kT = 3 − 2 exp(−2 γ t/m), within 0.7 % of 20,000 particles.
            self.assertAlmostEqual(simulation.observe()["temperature"] / (3 - 2 * math.exp(-2 * time)), 1, delta=0.03)

    def test_refusals_name_the_quantity(self):
        discs, hard = stripmine.scene("two-discs").start(), stripmine.scene("hard-disks", {"particles.count": 56}).start()
        shear, lid = stripmine.scene("shear-cell").start(), stripmine.scene("piston").start()
        for simulation, quantities, words in (
            (discs, {"velocities": np.zeros((3, 2))}, r"velocities has the shape \(3, 2\)\n  help: give an array of the shape \(2, 2\)"),
            (discs, {"velocities": np.zeros(4)}, r"velocities has the shape \(4,\)"),
            (discs, {"gravity": 1.0}, r"gravity has the shape \(\)\n  help: give an array of the shape \(2,\)"),
            (discs, {"velocities": [[0.0, 1.0], [math.nan, 0.0]]}, r"velocities\[1, 0\] is NaN"),
            (discs, {"gravity": (0.0, math.inf)}, r"gravity\[1\] is inf"),
            (discs, {"bath_temperature": 1.0}, "no bath_temperature to change: its discs are in no bath\n  help: change velocities"),
            (hard, {"bath_temperature": 1.0}, "no bath_temperature to change"),
            (hard, {"gravity": (0.0, -1.0)}, "nothing stops the fall across a periodic side"),
            (shear, {"wall_velocities": [[1.0, 0.0]]}, r"wall_velocities has the shape \(1, 2\)\n  help: give an array of the shape \(2, 2\)"),
            (shear, {"wall_velocities": [[1.0, 0.0], [500.0, 0.0]]}, r"wall_velocities\[1\] moves wall 2, at up to 500"),
            (lid, {"wall_velocities": [[1.0, 0.0]]}, r"wall_velocities\[0\] moves wall 1, which a force drives"),
        ):
            before = state(simulation)
            with self.subTest(quantities=quantities), self.assertRaisesRegex(stripmine.Error, words):
                simulation.set(**quantities)
            self.assertEqual(state(simulation), before)
        with self.assertRaisesRegex(TypeError, "expected one of velocities"):
            discs.set(mass=1.0)
        with self.assertRaises((TypeError, ValueError)):
            discs.set(gravity="down")
        discs.set(gravity=None)


class Recording(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def files(self, folder):
        return {name: (self.folder / folder / name).read_bytes() for name in ("thermo.csv", "trajectory.xyz", "changes.csv")}

    def test_recorded_simulations_have_the_files_of_runs(self):
        # Walls add columns to the rows.
        for preset, overrides in (("two-discs", {}), ("hopper", {"particles.count": 20})):
            with self.subTest(preset):
                scene, out = stripmine.scene(preset, {**overrides, **SHORT}), self.folder / preset
                scene.run(out / "run")
                simulation = scene.start(out / "pieces")
                for steps in (70, 130, 200):
                    simulation.advance(steps=steps)
                run = simulation.finish()
                self.assertEqual(run.summary()["steps"], 400)
                for name in ("thermo.csv", "trajectory.xyz", "scene.toml"):
                    self.assertEqual((out / "run" / name).read_bytes(), (out / "pieces" / name).read_bytes(), name)
                with self.assertRaisesRegex(stripmine.Error, "the run is finished\n  help: continue it"):
                    simulation.advance(steps=1)
                # It goes on beyond the end of the scene.
                simulation = scene.start(out / "pieces", resume=True)
                self.assertEqual((simulation.step, simulation.folder), (400, out / "pieces"))
                simulation.advance(steps=100)
                self.assertEqual(simulation.finish().thermo()["step"][-1], 500)

    def test_resumed_changes_have_the_same_bits(self):
        scene = stripmine.scene("two-discs", SHORT)

        def changed(out):
            simulation = scene.start(self.folder / out)
            simulation.advance(steps=130)
            simulation.set(gravity=(0.0, -1.0))
            simulation.advance(steps=40)
            simulation.set(velocities=1.5 * simulation.particles().velocities)
            return simulation

        whole = changed("whole")
        whole.advance(steps=230)
        whole.finish()
        # Without a checkpoint since step 100, which is as if the process had been killed.
        del whole
        lost = changed("lost")
        del lost
        scene.run(self.folder / "lost", resume=True)
        self.assertEqual(self.files("lost"), self.files("whole"))
        pieces = changed("pieces")
        del pieces
        pieces = scene.start(self.folder / "pieces", resume=True)
        self.assertEqual(pieces.step, 100)
        with self.assertRaisesRegex(stripmine.Error, "was changed at step 170 before it was interrupted, and this is step 100"):
            pieces.set(gravity=(0.0, 0.0))
        pieces.advance(steps=300)
        summary = pieces.finish().summary()
        self.assertEqual(self.files("pieces"), self.files("whole"))
        self.assertEqual(summary["work_of_changes"], stripmine.read(self.folder / "whole").summary()["work_of_changes"])

    def test_saved_simulations_continue_with_the_same_bits(self):
        for name, overrides in scenes.SHORT.items():
            with self.subTest(name):
                simulation = stripmine.scene(name, overrides).start()
                stride = {"time": 0.5} if name == "hard-disks" else {"steps": 20}
                simulation.advance(**stride)
                simulation.set(velocities=1.25 * simulation.particles().velocities)
                seen = simulation.observe()
                simulation.save(self.folder / name)
                with self.assertRaisesRegex(stripmine.RunError, "already contains a run"):
                    simulation.save(self.folder / name)
                simulation.save(self.folder / name, overwrite=True)
                other = stripmine.Simulation.restore(self.folder / name)
                self.assertEqual((other.observe(), simulation.observe(), other.folder), (seen, seen, None))
                other.advance(**stride)
                simulation.advance(**stride)
                self.assertEqual(state(other), state(simulation))
                self.assertEqual(other.observe(), simulation.observe())

    def test_wrong_folders_are_refused(self):
        scene = stripmine.scene("two-discs", SHORT)
        simulation = scene.start()
        for wrong, words in (
            (simulation.save, "save needs a folder"),
            (simulation.finish, "only a recorded simulation can be finished"),
            (lambda: scene.start(resume=True), "need a folder"),
            (lambda: scene.start(self.folder / "a", resume=True, overwrite=True), "exclude each other"),
            (lambda: scene.start(self.folder / "a", other_version=True), "other_version needs resume"),
            (lambda: scene.start(self.folder / "a").save(self.folder / "b"), "saved in its own folder"),
        ):
            with self.subTest(words), self.assertRaisesRegex(stripmine.Error, words):
                wrong()
        with self.assertRaises(stripmine.Error):
            stripmine.Simulation.restore(self.folder / "nowhere")
        stripmine.scene("two-discs", SHORT).run(self.folder / "run")
        for name in ("run.checkpoint", "run.checkpoint.previous"):
            (self.folder / "run" / name).unlink(missing_ok=True)
        with self.assertRaisesRegex(stripmine.RunError, "run.checkpoint: there is none"):
            stripmine.Simulation.restore(self.folder / "run")


@COMMAND
class Command(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def test_comparisons_find_the_first_difference(self):
        scene = stripmine.scene("two-discs", SHORT)
        same = scene.compare({"search.by": "sectors"})
        self.assertEqual((same["same_bits"], same["first_difference"]), (True, None))
        other = scene.compare({"particles.velocities": [[1.0, 0.0], [0.0, 1e-6]]})
        self.assertEqual((other["same_bits"], other["first_difference"], other["looks"][0]["velocity"]), (False, 0, 1e-6))
        with self.assertRaisesRegex(stripmine.Error, "unknown key `dtt`"):
            scene.compare({"integrator.dtt": 1e-4})

    def test_runs_are_drawn_and_filmed(self):
        scene = stripmine.scene("two-discs", SHORT)
        run = scene.run(self.folder / "discs.run")
        pictures = run.plot(["kinetic"])
        self.assertTrue(all(it.is_file() and it.parent == self.folder / "discs.plots" for it in pictures))
        self.assertTrue(any(it.name == "kinetic.svg" for it in pictures), pictures)
        film = run.film(color="speed", out=self.folder / "film")
        self.assertEqual(film, self.folder / "film" / "film.html")
        self.assertTrue(film.is_file())
        with self.assertRaisesRegex(stripmine.Error, "kinetik"):
            run.plot("kinetik")
        with self.assertRaisesRegex(stripmine.Error, "temporary folder\n  help: pass out="):
            scene.run().plot()

    def test_starts_are_drawn_with_their_walls(self):
        text = stripmine.scene("two-discs").toml() + "[[walls]]\nfrom = [1.0, 1.0]\nto = [11.0, 2.0]\n"
        other = "[[walls]]\nfrom = [1.0, 7.0]\nto = [11.0, 6.0]\n"
        paths = []
        for name, walled in (("one", stripmine.scene(text)), ("two", stripmine.scene(text + other))):
            pictures = walled.plot(self.folder / name)
            self.assertEqual(pictures, [self.folder / name / file for file in ("start.svg", "start.png")])
            self.assertTrue(pictures[1].read_bytes().startswith(b"\x89PNG"))
            paths.append(pictures[0].read_text().count("<path"))
        self.assertEqual(paths[1], paths[0] + 1)
        with self.assertRaisesRegex(stripmine.Error, "invalid value 'spede'"):
            walled.plot(self.folder / "start", color="spede")


if __name__ == "__main__":
    unittest.main()
