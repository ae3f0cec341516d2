"""Threads, Ctrl-C and forks."""

import gc
import multiprocessing
import os
import signal
import tempfile
import threading
import unittest
from pathlib import Path

import numpy as np

import stripmine

from . import scenes

# A run longer than any test.
LONG = {"particles.count": 400, "run.steps": 10_000_000}


def interrupted_soon():
    """Sends Ctrl-C to this process after 0.3 s."""
    timer = threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    return timer


def child(ask, answer):
    """Calls `ask` in a forked process and returns its outcome in a queue."""
    try:
        ask()
        answer.put("computed")
    except stripmine.Error as error:
        answer.put(str(error))


class Threads(unittest.TestCase):
    def test_simulations_are_for_one_thread(self):
        simulation = stripmine.scene("dense-gas", LONG).start()
        simulation.advance(steps=1)
        done = threading.Event()

        def work():
            simulation.advance(steps=20_000)
            done.set()

        worker = threading.Thread(target=work)
        worker.start()
        refused = set()
        while not done.is_set():
            try:
                simulation.observe()
            except stripmine.BusyError as error:
                refused.add(str(error))
        worker.join()
        self.assertEqual(["another thread" in words for words in refused], [True])
        self.assertEqual(simulation.step, 20_001)

    def test_two_simulations_advance_side_by_side(self):
        scene = stripmine.scene("dense-gas", scenes.SHORT["dense-gas"])
        simulations = [scene.start() for _ in range(4)]
        workers = [threading.Thread(target=it.advance, kwargs={"steps": 200}) for it in simulations]
        [it.start() for it in workers]
        [it.join() for it in workers]
        self.assertEqual(len({it.particles().positions.tobytes() for it in simulations}), 1)


class Interruption(unittest.TestCase):
    def test_interrupted_advances_can_continue(self):
        for name in scenes.SHORT:
            with self.subTest(name):
                scene = stripmine.scene(name, {"particles.count": 200} if name != "pipe-small" else None)
                simulation, other = scene.start(), scene.start()
                timer = interrupted_soon()
                far = {"time": 1e9} if name == "hard-disks" else {"steps": 10**12}
                with self.assertRaises(KeyboardInterrupt):
                    simulation.advance(**far)
                timer.join()
                if name == "hard-disks":
                    simulation.advance(events=10)
                    other.advance(events=simulation.events)
                else:
                    simulation.advance(steps=10)
                    other.advance(steps=simulation.step)
                self.assertEqual(simulation.observe(), other.observe())

    def test_long_steps_finish(self):
        # Bodies can be interrupted within a step, which then starts over; this step takes a second.
        scene = stripmine.scene("cold-collapse", {"integrator.kind": "gear-6", "run.steps": 2, "run.thermo_every": 1})
        simulation = scene.start()
        simulation.advance(steps=1)
        simulation.advance(steps=1)
        np.testing.assert_array_equal(simulation.particles().positions, [*scene.run().frames()][-1].particles.positions)

    def test_interrupted_runs_leave_checkpoints(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = stripmine.scene("dense-gas", {**LONG, "run.thermo_every": 100, "run.snapshot_every": 0})
            timer = interrupted_soon()
            with self.assertRaises(KeyboardInterrupt):
                scene.run(folder)
            timer.join()
            self.assertTrue((Path(folder) / "run.checkpoint").exists())
            steps = int(stripmine.read(folder).thermo()["step"][-1])
            end = {**LONG, "run.steps": steps + 20_000, "run.thermo_every": 100, "run.snapshot_every": 0}
            stripmine.scene("dense-gas", end).run(folder, resume=True)
            self.assertEqual(stripmine.read(folder).summary()["steps"], steps + 20_000)


@unittest.skipUnless(hasattr(os, "fork"), "this system has no fork")
class Forks(unittest.TestCase):
    def heard(self, ask):
        context = multiprocessing.get_context("fork")
        answer = context.Queue()
        process = context.Process(target=child, args=(ask, answer))
        process.start()
        said = answer.get(timeout=60)
        process.join()
        return said

    def test_forked_children_get_errors(self):
        scene = stripmine.scene("dense-gas", scenes.SHORT["dense-gas"])
        simulation, run = scene.start(), scene.run()
        for ask in (lambda: simulation.advance(steps=1), simulation.observe, scene.start, scene.run, run.averages):
            self.assertIn("forked", self.heard(ask))
        # Calls that need no threads work, and the parent's folder stays.
        self.assertEqual(self.heard(run.thermo), "computed")
        self.assertTrue(run.folder.exists())
        simulation.advance(steps=1)


class Folders(unittest.TestCase):
    def test_temporary_folders_are_removed(self):
        run = stripmine.scene("two-discs", {"run.steps": 10}).run()
        folder, frames = run.folder, run.frames()
        del run
        gc.collect()
        self.assertTrue(folder.exists())
        self.assertEqual(len(next(frames).particles), 2)
        del frames
        gc.collect()
        self.assertFalse(folder.exists())


if __name__ == "__main__":
    unittest.main()
