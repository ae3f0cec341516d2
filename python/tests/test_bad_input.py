"""Invalid input raises an exception with the message of the command line, and never ends the process."""

import json
import pickle
import subprocess
import tempfile
import unittest
from pathlib import Path

import numpy as np

import stripmine

from . import scenes

# Preset, overrides, and a pattern of the error message.
WRONG = [
    ("hard-disks", {"particles.cuont": 5}, "did you mean `particles.count`"),
    ("hard-disks", {"particels.count": 5}, r"did you mean \[particles\]"),
    ("hard-disks", {"particles.count": "many"}, "`particles.count` is the text"),
    ("hard-disks", {"particles.count": 2.5}, "`particles.count` cannot be the number 2.5"),
    ("hard-disks", {"particles.count": -1}, "`particles.count` cannot be the number -1"),
    ("hard-disks", {"particles.count": True}, "`particles.count` is"),
    ("hard-disks", {"particles.count": 10**30}, "`particles.count`"),
    ("hard-disks", {"particles.count": [1, 2]}, "`particles.count` is"),
    ("hard-disks", ["particles.cuont=5"], "did you mean `particles.count`"),
    ("hard-disks", ["particles.count"], "."),
    ("hard-disks", {"particles": 3}, "without a section|is not a table"),
    ("hard-disks", {"particles": {"count": {"a": 1}}}, "`particles.count` is"),
    ("hard-disks", {"particles.packing_fraction": float("nan")}, "`particles.packing_fraction` cannot be"),
    ("hard-disks", {"particles.packing_fraction": np.float64("inf")}, "`particles.packing_fraction` cannot be"),
    ("hard-disks", {"particles.packing_fraction": 0.99}, "."),
    ("hard-disks", {"method.kind": "hard-discs"}, 'did you mean "hard-disks"'),
    ("hard-disks", {"": 1}, "."),
    ("hard-disks", {"a=b\n\x1b[31m": 1}, "unknown"),
    ("hard-disks", {"run.until": {"quantity": "presure", "error": "1%"}}, "."),
    ("no-such-scene", {}, "no such preset and no such file"),
    ("hard-discs", {}, "did you mean hard-disks"),
    ("/", {}, "cannot be read"),
    ("a\0b", {}, "."),
    ("format = \n[[[", {}, "not TOML"),
    ("\n", {}, "."),
    ("two-discs", {"particles.positions": np.zeros((3, 2))}, "."),
    ("two-discs", {"particles.positions": np.zeros((2, 3))}, r"`particles.positions` has the shape \(2, 3\)"),
    ("two-discs", {"particles.positions": np.zeros(4)}, r"has the shape \(4,\)\n  expected: the shape \(N, 2\)"),
    ("two-discs", {"particles.positions": np.array([[0.5, 1.0], [2.0, np.inf]])}, r"`particles.positions`\[1, 1\] is inf"),
    ("two-discs", {"particles.radii": np.array([0.5, 0.0])}, r"`particles.radii`\[1\] is 0"),
    ("two-discs", {"particles.masses": np.ones(3)}, "`particles.masses` lists 3 values"),
    ("two-discs", {"particles.count": np.ones(3)}, "`particles.count` is an array"),
    ("two-discs", {"particles.poistions": np.ones((3, 2))}, "did you mean"),
    ("two-discs", {"particles.positions": np.zeros((0, 2))}, "."),
    ("two-discs", {"particles.positions": np.full((2, 2), np.nan)}, r"`particles.positions`\[0, 0\] is NaN"),
    ("two-discs", {"particles.velocities": [[1.0, 0.0]]}, "."),
    ("two-discs", {"particles.positions": [[1.0, 1.0], [1.0, 1.0]]}, "."),
    ("two-discs", {"integrator.dt": 1e9}, "."),
]

# Two discs that collide so fast that they overlap too much.
TOO_FAST = {"particles.velocities": [[30.0, 0.0], [-30.0, 0.0]]}

# Arguments that no scene can have.
UNTYPED = [
    lambda: stripmine.scene(3),
    lambda: stripmine.scene(None),
    lambda: stripmine.scene(b"hard-disks"),
    lambda: stripmine.scene("hard-disks", 3),
    lambda: stripmine.scene("hard-disks", [3]),
    lambda: stripmine.scene("hard-disks", "particles.count=5"),
    lambda: stripmine.scene("hard-disks", {3: 4}),
    lambda: stripmine.scene("hard-disks", {"particles.count": None}),
    lambda: stripmine.scene("hard-disks", {"particles.count": {1, 2}}),
    lambda: stripmine.scene("hard-disks", {"particles.count": 1j}),
    lambda: stripmine.scene("hard-disks", {"particles.count": object()}),
    lambda: stripmine.scene("hard-disks", {"particles": {3: 4}}),
    lambda: stripmine.read(3),
    lambda: stripmine.average(3),
    lambda: stripmine.Scene(),
    lambda: stripmine.Simulation(),
    lambda: stripmine.Run(),
    lambda: stripmine.Table(),
    lambda: stripmine.Particles(),
]


class Scenes(unittest.TestCase):
    def test_wrong_scenes_raise_scene_errors(self):
        for name, overrides, words in WRONG:
            with self.subTest(name=name, overrides=str(overrides)):
                with self.assertRaisesRegex(stripmine.SceneError, words) as caught:
                    stripmine.scene(name, overrides)
                self.assertTrue(caught.exception.mistakes)
                self.assertNotIn("\x1b", str(caught.exception))

    def test_invalid_types_raise_type_errors(self):
        for number, wrong in enumerate(UNTYPED):
            with self.subTest(number), self.assertRaises(TypeError):
                wrong()
        endless = []
        endless.append(endless)
        with self.assertRaises(TypeError):
            stripmine.scene("two-discs", {"particles.positions": endless})
        with self.assertRaises(UnicodeError):
            stripmine.scene("two-discs", {"particles.file": "\ud800"})

    def test_all_mistakes_have_their_location(self):
        text = 'format = 2\nunits = "reduced"\n[method]\nkind = "hard-disks"\n[particles]\ncount = "x"\nradis = 1\n'
        with self.assertRaises(stripmine.SceneError) as caught:
            stripmine.scene(text, {"run.tme": 1})
        mistakes = caught.exception.mistakes
        self.assertEqual([(it.line, it.column) for it in mistakes if it.line in (6, 7)], [(6, 9), (7, 1)])
        self.assertIn("--set run.tme=1", [it.file for it in mistakes])
        self.assertEqual(caught.exception.kind, "input")
        self.assertLessEqual({"type", "unknown", "missing"}, {it.reason for it in mistakes})
        self.assertIsInstance(caught.exception, ValueError)

    @unittest.skipUnless(scenes.command(), "there is no command `stripmine`: set STRIPMINE, or the path")
    def test_messages_match_the_command(self):
        for name, overrides in [("hard-disks", {"particles.cuont": 5, "law.restitution": 7}), ("hard-discs", {})]:
            arguments = [scenes.command(), "scene", "check", name, *scenes.flat(overrides)]
            said = subprocess.run(arguments, capture_output=True, text=True).stderr
            with self.assertRaises(stripmine.SceneError) as caught:
                stripmine.scene(name, overrides)
            self.assertEqual(said.strip(), f"error: {caught.exception}".strip())


class Advancing(unittest.TestCase):
    def test_invalid_distances_are_rejected(self):
        soft, hard = (stripmine.scene(name, scenes.SHORT[name]).start() for name in ("dense-gas", "hard-disks"))
        for simulation, given, kind in [
            (soft, {}, TypeError),
            (soft, {"steps": 1, "time": 1.0}, TypeError),
            (soft, {"steps": -1}, ValueError),
            (soft, {"steps": 1.5}, TypeError),
            (soft, {"steps": "1"}, TypeError),
            (soft, {"steps": 10**30}, OverflowError),
            (soft, {"events": 1}, ValueError),
            (soft, {"time": float("nan")}, ValueError),
            (soft, {"time": float("inf")}, ValueError),
            (soft, {"time": -1.0}, ValueError),
            (hard, {"steps": 1}, ValueError),
            (hard, {"events": -1}, ValueError),
        ]:
            with self.subTest(given=given), self.assertRaises(kind):
                simulation.advance(**given)
        with self.assertRaises(TypeError):
            soft.advance(1)
        self.assertEqual((soft.step, soft.time, hard.time), (0, 0.0, 0.0))
        soft.advance(steps=np.int64(2))
        self.assertEqual(soft.step, 2)

    def test_failed_simulations_do_not_continue(self):
        simulation = stripmine.scene("two-discs", TOO_FAST).start()
        with self.assertRaises(stripmine.SimulationError) as first:
            simulation.advance(steps=1000)
        error = first.exception
        self.assertTrue(error.failure and error.remedy and error.particles, vars(error))
        self.assertGreater(error.step, 0)
        self.assertTrue(str(error).startswith(f"step {error.step}: "))
        with self.assertRaises(stripmine.SimulationError) as again:
            simulation.advance(steps=1)
        self.assertEqual(str(error), str(again.exception))
        # Its state can still be read.
        simulation.observe()
        simulation.particles()

    def test_failed_runs_report_location_and_reason(self):
        scene = stripmine.scene("two-discs", TOO_FAST)
        with tempfile.TemporaryDirectory() as folder:
            with self.assertRaisesRegex(stripmine.SimulationError, "last frame of"):
                scene.run(folder)
            self.assertIsNotNone(stripmine.read(folder).summary()["failure"])
        with self.assertRaisesRegex(stripmine.SimulationError, "stop_penetration = 0.3\n  help: ") as caught:
            scene.run()
        self.assertEqual([it["id"] for it in caught.exception.particles], [1, 2])


class Errors(unittest.TestCase):
    def test_errors_can_be_pickled(self):
        simulation = stripmine.scene("two-discs", TOO_FAST).start()
        for fail in (
            lambda: stripmine.scene("two-discs", {"a.b": 1}),
            lambda: simulation.advance(steps=1000),
            lambda: stripmine.read("/nowhere"),
            lambda: stripmine.scene("two-discs").run(resume=True, overwrite=True),
        ):
            with self.assertRaises(stripmine.Error) as caught:
                fail()
            error = caught.exception
            again = pickle.loads(pickle.dumps(error))
            self.assertEqual((type(again), str(again), vars(again)), (type(error), str(error), vars(error)))


class Folders(unittest.TestCase):
    def test_occupied_folders_are_rejected(self):
        scene = stripmine.scene("two-discs", {"run.steps": 10})
        with tempfile.TemporaryDirectory() as folder:
            scene.run(folder)
            with self.assertRaisesRegex(stripmine.RunError, "already contains a run") as caught:
                scene.run(folder)
            self.assertEqual((caught.exception.kind, caught.exception.file), ("usage", folder))
            scene.run(folder, overwrite=True)
            scene.run(folder, resume=True)
            for wrong in ({"resume": True, "overwrite": True}, {"other_version": True}):
                with self.assertRaises(stripmine.Error):
                    scene.run(folder, **wrong)
            other = stripmine.scene("two-discs", {"run.steps": 10, "integrator.dt": 1e-5})
            with self.assertRaisesRegex(stripmine.RunError, "another scene"):
                other.run(folder, resume=True)
            with self.assertRaises(stripmine.RunError):
                scene.run(Path(folder) / "thermo.csv")
        with self.assertRaises(stripmine.RunError):
            scene.run("/proc/nowhere")

    def test_folders_without_a_run_are_rejected(self):
        with self.assertRaisesRegex(stripmine.RunError, "thermo.csv"):
            stripmine.read("/nowhere")
        with tempfile.TemporaryDirectory() as folder:
            for text in ("", "a,b\n1,2\n", "step,time\n1,2\n", "step,time\n\xff\n"):
                (Path(folder) / "thermo.csv").write_text(text, encoding="latin-1")
                with self.subTest(text), self.assertRaises(stripmine.RunError):
                    stripmine.read(folder)

    def test_damaged_files_are_reported(self):
        with tempfile.TemporaryDirectory() as folder:
            run = stripmine.scene("two-discs", {"run.steps": 10}).run(folder)
            (Path(folder) / "trajectory.xyz").write_text("3\nnothing\n")
            with self.assertRaisesRegex(stripmine.RunError, "trajectory.xyz"):
                list(run.frames())
            (Path(folder) / "summary.json").write_text("{")
            with self.assertRaises(json.JSONDecodeError):
                run.summary()
            (Path(folder) / "scene.toml").unlink()
            with self.assertRaises(stripmine.RunError):
                run.toml()

    def test_unrelated_runs_are_not_joined(self):
        runs = [stripmine.scene("hard-disks", {**scenes.SHORT["hard-disks"], "particles.seed": seed}).run() for seed in (1, 2)]
        self.assertEqual(len(stripmine.average(*runs)), len(runs[0].averages()))
        with self.assertRaisesRegex(stripmine.RunError, "are the same run"):
            stripmine.average(runs[0], runs[0])
        other = stripmine.scene("two-discs", {"run.steps": 10}).run()
        with self.assertRaisesRegex(stripmine.RunError, "have different scenes"):
            stripmine.average(runs[0], other)
        self.assertEqual(len(stripmine.average()), 0)


if __name__ == "__main__":
    unittest.main()
