"""Objects in other folders, in other processes, and as copies; advancing in pieces."""

import copy
import multiprocessing
import os
import pickle
import tempfile
import unittest
from pathlib import Path

import numpy as np
import stripmine

ARRAYS = ("id", "wall", "positions", "velocities", "angle", "angular_velocity", "radius", "mass")


def advanced(scene):
    simulation = scene.start()
    simulation.advance(time=1.0)
    return simulation.time, simulation.particles()


class ElsewhereTest(unittest.TestCase):
    def same(self, ours, theirs):
        for name in ARRAYS:
            np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name), name)

    def test_runs_are_read_from_any_folder(self):
        with tempfile.TemporaryDirectory() as folder:
            before = os.getcwd()
            try:
                os.chdir(folder)
                run = stripmine.scene("two-discs", {"run.steps": 20}).run("here.run")
                again = stripmine.read("here.run")
                os.mkdir("sub")
                os.chdir("sub")
                for it in (run, again):
                    self.assertTrue(Path(it.folder).is_absolute())
                    self.assertEqual(len(it.thermo()), len(run.thermo()))
                    self.assertEqual(it.summary()["steps"], 20)
                    self.assertGreater(len(list(it.frames())), 0)
            finally:
                os.chdir(before)

    def test_copies_are_identical(self):
        scene = stripmine.scene("hard-disks", {"particles.count": 56})
        with tempfile.TemporaryDirectory() as folder:
            run = stripmine.scene("two-discs", {"run.steps": 20, "run.snapshot_every": 10}).run(folder)
            frame = next(iter(run.frames()))
            for copied in (copy.copy, copy.deepcopy, lambda it: pickle.loads(pickle.dumps(it))):
                self.assertEqual(copied(scene).toml(), scene.toml())
                self.same(copied(scene).particles(), scene.particles())
                self.same(copied(scene.particles()), scene.particles())
                self.assertEqual(copied(run).folder, run.folder)
                self.same(copied(frame).particles, frame.particles)
                for name in ("time", "step", "sides", "origin", "periodic"):
                    self.assertEqual(getattr(copied(frame), name), getattr(frame, name))
            # A deep copy has its own arrays.
            particles = scene.particles()
            deep = copy.deepcopy(particles)
            deep.positions[0] += 1.0
            self.same(particles, scene.particles())
            for thing, words in (
                (scene.start(), "pass the scene"),
                (run.frames(), "pass the run"),
                (run.thermo(), "to_pandas"),
                (stripmine.scene("two-discs", {"run.steps": 1}).run(), "scene.run\\(out\\)"),
            ):
                for of in (pickle.dumps, copy.copy, copy.deepcopy):
                    with self.assertRaisesRegex(TypeError, words):
                        of(thing)

    def test_scenes_can_be_sent_to_processes(self):
        scene = stripmine.scene("hard-disks", {"particles.count": 56})
        with multiprocessing.get_context("spawn").Pool(1) as pool:
            [(time, particles)] = pool.map(advanced, [scene])
        expected = advanced(scene)
        self.assertEqual(time, expected[0])
        self.same(particles, expected[1])

    def test_times_in_pieces_add_up(self):
        few = {"particles.count": 100}
        for name, overrides, piece, times, steps in (
            ("langevin-dense", {}, 0.05, 200, 2000),
            ("langevin-free", few, 0.1, 100, 1000),
            # A step and a half, and half a step.
            ("langevin-free", few, 0.015, 100, 150),
            ("langevin-free", few, 0.005, 100, 50),
            ("two-discs", {}, 0.003, 100, None),
            ("kepler", {"integrator.dt": 0.01}, 0.1, 200, 2000),
        ):
            with self.subTest(name, piece=piece):
                scene = stripmine.scene(name, overrides)
                pieces, whole = scene.start(), scene.start()
                whole.advance(time=piece * times)
                for _ in range(times):
                    pieces.advance(time=piece)
                self.assertEqual(pieces.step, whole.step)
                if steps is not None:
                    self.assertEqual(pieces.step, steps)
                self.assertEqual(pieces.time, whole.time)
                self.same(pieces.particles(), whole.particles())

    def test_hard_discs_reach_times_exactly(self):
        for name, overrides in (
            ("hard-disks", {"particles.count": 100}),
            ("hard-disks", {"particles.count": 100, "machine.engine": "reference"}),
        ):
            scene = stripmine.scene(name, overrides)
            whole = scene.start()
            whole.advance(time=10.0)
            for piece, times in ((0.1, 100), (0.125, 80), (1.0, 10), (0.01, 1000)):
                pieces = scene.start()
                for _ in range(times):
                    pieces.advance(time=piece)
                self.assertEqual((pieces.time, pieces.events), (whole.time, whole.events))
                self.same(pieces.particles(), whole.particles())

    def test_steps_after_a_time_continue_there(self):
        simulation = stripmine.scene("langevin-free", {"particles.count": 4}).start()
        simulation.advance(time=0.025)
        self.assertEqual(simulation.step, 3)
        simulation.advance(steps=1)
        simulation.advance(time=0.02)
        self.assertEqual(simulation.step, 6)


if __name__ == "__main__":
    unittest.main()
