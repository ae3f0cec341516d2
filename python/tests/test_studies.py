"""Plans and the accuracy of means, found by the command."""

import os
import signal
import stat
import tempfile
import threading
import time
import unittest
from pathlib import Path
from unittest import mock

import numpy as np

import stripmine

from . import scenes

# Discs of packing fraction 0.5. In the limit of many discs p A / (N k T) is 4.125 by Henderson, (1 + ν²/8) / (1 - ν)² (Mol. Phys. 30, 971, 1975).
DISCS = {"particles.count": 400, "particles.packing_fraction": 0.5}
HENDERSON = 1.03125 / 0.25
# Relative tolerance for 400 discs and a run of a few seconds.
CLOSE = 0.012

# For tests with a shell script instead of the command.
SHELL = unittest.skipUnless(os.name == "posix", "this system has no sh")
COMMAND = unittest.skipUnless(scenes.command(), "there is no command `stripmine`: set STRIPMINE, or the path")

# First line of a script that pretends to be the command.
VERSION = f'[ "$1" = --version ] && echo stripmine {stripmine.__version__} && exit\n'


def program(folder, lines):
    """A shell script with these lines."""
    path = Path(folder, "command")
    path.write_text(f"#!/bin/sh\n{lines}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return path


class InFolder(unittest.TestCase):
    """Tests with a folder in which the command caches its measurements."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        kept = mock.patch.dict(os.environ, {"XDG_CACHE_HOME": folder.name})
        kept.start()
        self.addCleanup(kept.stop)


class Commands(InFolder):
    scene = stripmine.scene("hard-disks", {"particles.count": 100})

    def refused(self, words, **options):
        for study in (self.scene.explain, self.scene.accuracy):
            with self.assertRaisesRegex(stripmine.Error, words) as caught:
                study(**options)
        return caught.exception

    def test_a_missing_command_is_explained(self):
        with mock.patch.dict(os.environ, {"PATH": str(self.folder), "STRIPMINE": ""}):
            error = self.refused("the command stripmine was not found\n.*cargo install --path")
        self.assertIn("command=", error.remedy)
        with mock.patch.dict(os.environ, {"STRIPMINE": "/no/such/program"}):
            self.refused("the command /no/such/program was not found")
        self.refused("no-such-command was not found", command="no-such-command")

    @SHELL
    def test_other_command_versions_are_rejected(self):
        other = program(self.folder, "echo stripmine 0.0.1")
        self.refused(f"'stripmine 0.0.1'; .* needs stripmine {stripmine.__version__}\n.*cargo install", command=other)
        self.refused("is ''; this package needs", command=program(self.folder, "exit 1"))

    @SHELL
    def test_options_are_passed_to_the_command(self):
        command = program(self.folder, VERSION + """printf '{"arguments": "%s"}' "$*" """)
        plan = self.scene.explain("q", np.float64(0.5), time=2, limit=3.5, window=(4, 5), seconds=6, command=command)
        options = "--of=q --error=0.5 --time=2 --limit=3.5 --seconds=6 --window 4 5 --json"
        self.assertEqual(plan, {"arguments": f"explain scene.toml {options}"})
        self.assertEqual(self.scene.explain(command=command), {"arguments": "explain scene.toml --json"})

    @SHELL
    def test_values_of_a_scan_are_passed(self):
        command = program(self.folder, VERSION + """printf '{"keys": [], "points": [{"folders": ["%s"], "averages": null, "failure": null}]}' "$#" """)
        over = {"particles.radius": np.array([0.25, 0.5]), "search.by": ["lattice", "auto"], "domain.sides": [[1, 2.5]]}
        table = self.scene.scan(over, 3, "q=1%", resume=True, command=command)
        self.assertEqual((table.columns, table["runs"].tolist(), table["failure"].tolist()), (["runs", "failure"], [1], [""]))
        arguments = self.folder / "arguments"
        command = program(self.folder, VERSION + f"""printf '%s\\n' "$@" > {arguments}; echo '{{"keys": [], "points": []}}' """)
        self.scene.scan(over, 3, "q=1%", out="a.scan", resume=True, command=command)
        expected = ["scan", "scene.toml", "--seeds=3", "--until=q=1%", f"--out={Path('a.scan').absolute()}"]
        expected += ["--over=particles.radius=0.25,0.5", '--over=search.by="lattice","auto"', "--over=domain.sides=[1, 2.5]"]
        self.assertEqual(arguments.read_text().splitlines(), [*expected, "--resume", "--json"])
        with self.assertRaisesRegex(ValueError, "particles.radius has no values"):
            self.scene.scan({"particles.radius": []}, command=command)

    @SHELL
    def test_failing_commands_raise_their_message(self):
        for lines in ("echo broken >&2; exit 3", "echo '{\"error\": 0.5}'; echo broken >&2; exit 3", "echo '['; echo broken >&2; exit 3"):
            self.refused("failed with exit code 3: broken", command=program(self.folder, VERSION + lines))
        program(self.folder, "").write_bytes(b"\x7fELF")
        self.refused("cannot be run", command=self.folder / "command")

    def test_unknown_options_raise_type_errors(self):
        for study in (self.scene.explain, self.scene.accuracy, self.scene.compare, self.scene.scan, self.scene.plot):
            with self.assertRaisesRegex(TypeError, "budgte"):
                study({}, budgte=3)


@COMMAND
class Studies(InFolder):
    def test_a_plan_of_discs_reaches_its_error(self):
        scene = stripmine.scene("hard-disks", DISCS)
        plan = scene.explain("compressibility", "2%", seconds=4)
        self.assertEqual((plan["quantity"], plan["method"]), ("compressibility", "hard-disks"))
        self.assertAlmostEqual(plan["mean"][0], HENDERSON, delta=CLOSE * HENDERSON)
        self.assertAlmostEqual(plan["error"], 0.02 * plan["mean"][0])
        seeds = [f"particles.seed={1 + run}" for run in range(plan["seeds"])]
        means = stripmine.average(*(stripmine.scene(scene.toml(), [*plan["overrides"], seed]).run() for seed in seeds))
        mean = means["mean"][means["quantity"] == "compressibility"]
        # The error of the plan, plus the finite-size error of 400 discs.
        np.testing.assert_allclose(mean, [HENDERSON], rtol=0.02 + CLOSE)
        # The second plan uses the trials of the first.
        self.assertIn("cached on", scene.explain("compressibility", 0.1, seconds=4)["origin"])

    def test_scans_agree_with_the_virial_series(self):
        # Hard discs: B3/B2² = 4/3 − √3/π, B4/B2³ = 0.53223180 (Clisby and McCoy, J. Stat. Phys. 122, 15, 2006); later terms are below 4·10⁻⁵ here.
        fractions = np.array([0.02, 0.05])
        known = 1 + 2 * fractions + (4 / 3 - 3**0.5 / np.pi) * (2 * fractions) ** 2 + 0.5322318 * (2 * fractions) ** 3
        out = self.folder / "out"
        scan = {"particles.packing_fraction": fractions}
        table = stripmine.scene("hard-disks", {"particles.count": 400}).scan(scan, until="compressibility=0.5%", out=out)
        np.testing.assert_array_equal(table["particles.packing_fraction"], fractions)
        bars = table["compressibility_error_95"]
        self.assertTrue((bars <= 0.005 * known * 1.01).all() and (bars > 0).all())
        # Of 400 discs, each has 399 partners.
        self.assertTrue((np.abs(table["compressibility"] - known) < 1.5 * bars + (known - 1) / 400).all())
        self.assertTrue((out / "compressibility.svg").is_file())
        self.assertEqual((table.units["kinetic"], table["runs"].tolist(), set(table["failure"])), ("energy", [1, 1], {""}))
        again = stripmine.scene("hard-disks", {"particles.count": 400}).scan(scan, until="compressibility=0.5%", out=out, resume=True)
        np.testing.assert_array_equal(again["compressibility"], table["compressibility"])
        # A point that fails is a row with its reason; one that is refused raises.
        short = stripmine.scene("hard-disks", {"particles.count": 100, "run.events": 2000}).scan(scan, until="compressibility=0.01%")
        self.assertTrue(all("latest end" in reason for reason in short["failure"]))
        with self.assertRaisesRegex(stripmine.Error, "packing_fraction` cannot be the number 0.99"):
            stripmine.scene("hard-disks").scan({"particles.packing_fraction": [0.1, 0.99]})

    def test_errors_fall_with_the_square_root(self):
        out = self.folder / "out"
        tables = stripmine.scene("hard-disks", DISCS).accuracy("compressibility", "2%", budget=6, out=out)
        self.assertEqual(set(tables), {"summary", "points", "marks", "biases", "wishes"})
        self.assertAlmostEqual(tables["summary"]["mean"][0], HENDERSON, delta=CLOSE * HENDERSON)
        points = tables["points"]
        self.assertEqual(points.columns[:2], ["configuration", "wall_time"])
        self.assertEqual((points.units["wall_time"], points["step"].dtype), ("s", np.float64))
        self.assertTrue(np.isnan(points["step"]).all())
        chosen = points["configuration"] == "fast"
        error, seconds = points["error"][chosen], points["wall_time"][chosen]
        # Eight points a decade: errors of long runs a decade apart.
        self.assertAlmostEqual(seconds[-1] / seconds[-9], 10, delta=1e-3)
        self.assertAlmostEqual(error[-9] / error[-1], 10**0.5, delta=0.05)
        self.assertIn("the plan", tables["marks"]["mark"])
        self.assertEqual(len(tables["biases"]), 0)
        self.assertIn("bias", tables["biases"])
        self.assertTrue([*out.glob("host/accuracy/*.svg")])

    def test_columns_of_biases_have_types(self):
        tables = stripmine.scene("dense-gas", {"particles.count": 200}).accuracy("kinetic", budget=6, window=(0.0, 1.0))
        biases = tables["biases"]
        self.assertEqual((biases["step"].dtype, biases["pairs_of_runs"].dtype), (np.float64, np.uint64))
        self.assertTrue(set(biases["significant"]) <= {"yes", "no"})
        self.assertTrue((tables["points"]["step"] > 0).all())

    def test_wrong_options_raise_command_errors(self):
        scene = stripmine.scene("hard-disks", DISCS)
        for options, message, remedy in [
            ({"of": "presure"}, "this scene does not observe `presure`\n  help: use one of", "compressibility"),
            ({"of": "compressibility", "error": "-1%"}, "'-1%' for '--error", ""),
            ({"of": "compressibility", "error": 0}, "'0' for '--error", ""),
            ({"window": (1,)}, "window", ""),
        ]:
            for study in (scene.explain, scene.accuracy):
                with self.subTest(options=options), self.assertRaisesRegex(stripmine.Error, message) as caught:
                    study(**options)
                self.assertEqual(caught.exception.kind, "usage")
                self.assertIn(remedy, caught.exception.remedy or "")
        with self.assertRaises(stripmine.Error):
            scene.explain(error="1%", time=3)
        with self.assertRaises(TypeError):
            scene.explain(window=3)

    @SHELL
    def test_interrupted_trials_are_cached(self):
        number = self.folder / "number"
        command = program(self.folder, f'echo $$ > "{number}"; exec "{os.path.abspath(scenes.command())}" "$@"')

        groups = []

        def trials():
            return [*self.folder.glob("stripmine/explain/*.trials-*/*")]

        def interrupt():
            while not trials():
                time.sleep(0.01)
            groups.append(os.getpgid(int(number.read_text())))
            os.kill(os.getpid(), signal.SIGINT)

        threading.Thread(target=interrupt, daemon=True).start()
        with self.assertRaises(KeyboardInterrupt):
            stripmine.scene("dense-gas").explain("kinetic", "0.1%", seconds=60, command=command)
        # A terminal sends Ctrl-C to the process group; the command gets it once.
        self.assertEqual(groups, [int(number.read_text())])
        with self.assertRaises(ProcessLookupError):
            os.kill(int(number.read_text()), 0)
        self.assertTrue(trials())

    def test_command_warnings_become_python_warnings(self):
        (self.folder / "stripmine").touch()
        with self.assertWarnsRegex(UserWarning, "trials are not cached"):
            stripmine.scene("hard-disks", DISCS).explain("compressibility", "5%", seconds=1)


if __name__ == "__main__":
    unittest.main()
