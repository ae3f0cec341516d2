"""Tables, lists and checks."""

import importlib.util
import json
import subprocess
import unittest

import numpy as np

import stripmine

from . import scenes


def there(name):
    return importlib.util.find_spec(name) is not None


class Tables(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        overrides = {"particles.count": 100, "run": {"time": 200.0, "thermo_every": 1.0, "snapshot_every": 0.0}}
        cls.run_of_discs = stripmine.scene("hard-disks", overrides).run()

    def test_columns_are_arrays_with_units(self):
        table = self.run_of_discs.thermo()
        self.assertEqual((len(table), table.columns[:2]), (201, ["step", "time"]))
        self.assertEqual((table["step"].dtype, table["time"].dtype), (np.uint64, np.float64))
        self.assertEqual((table.units["kinetic"], table.units["compressibility"]), ("energy", ""))
        self.assertIn("virial", table)
        with self.assertRaisesRegex(KeyError, "unknown column of this table"):
            table["virail"]

    def test_averages_match_the_summary(self):
        averages = self.run_of_discs.averages().to_dict()
        summary = self.run_of_discs.summary()["averages"]["quantities"]
        for at, theirs in enumerate(summary):
            for name in ("quantity", "unit", "of", "says"):
                self.assertEqual(averages[name][at], theirs[name])
            for name in ("mean", "bar", "standard_error", "correlation_time", "independent_samples"):
                self.assertEqual(np.nan_to_num(averages[name][at]), theirs.get(name, 0.0), (theirs["quantity"], name))

    def test_counts_match_the_printed_program(self):
        overrides = {"integrator.values": 5, "law.friction": 0.5, "law.normal_damping": 0.1, "law.shear_damping": 0.1}
        counts = stripmine.scene("dense-gas-printed", overrides).counts()
        self.assertEqual(counts.columns[:4], ["part", "section", "length", "n"])
        operations = {part: int(counts["operations"][counts["part"] == part].sum()) for part in set(counts["part"])}
        # Counts of `stripmine table`, plus the checks of a scene's programs: 30 operations in the forces, 8 in the corrector.
        self.assertEqual(
            [operations[part] for part in ("predictor", "index", "forces", "corrector")], [87, 20, 1596 + 30, 74 + 8]
        )
        self.assertTrue((counts["computing"] <= counts["operations"]).all())
        self.assertEqual(len(stripmine.scene("hard-disks").counts()), 0)

    def test_scenes_by_lists_are_counted_on_the_lattice(self):
        for preset in ["pipe-small", "dense-gas", "shaken-box", "two-discs"]:
            own = stripmine.scene(preset).counts()
            by_lattice = stripmine.scene(preset, {"search.by": "lattice"}).counts()
            self.assertGreater(int(own["operations"].sum()), 100, preset)
            self.assertEqual(list(own["operations"]), list(by_lattice["operations"]), preset)

    @unittest.skipUnless(there("pandas"), "there is no pandas")
    def test_pandas_reads_a_table(self):
        import pandas

        table = self.run_of_discs.averages()
        frame = table.to_pandas()
        self.assertEqual(list(frame.columns), table.columns)
        if there("pyarrow") and hasattr(pandas.DataFrame, "from_arrow"):
            other = pandas.DataFrame.from_arrow(table)
            np.testing.assert_array_equal(other["mean"].to_numpy(float), frame["mean"].to_numpy())

    @unittest.skipUnless(there("polars"), "there is no polars")
    def test_polars_reads_a_table(self):
        import polars

        thermo, averages = self.run_of_discs.thermo(), self.run_of_discs.averages()
        np.testing.assert_array_equal(polars.DataFrame(thermo)["virial"].to_numpy(), thermo["virial"])
        frame = polars.DataFrame(averages)
        self.assertEqual(frame["quantity"].to_list(), list(averages["quantity"]))
        self.assertEqual(frame["mean"].null_count(), int(np.isnan(averages["mean"]).sum()))

    @unittest.skipUnless(there("pyarrow"), "there is no pyarrow")
    def test_pyarrow_reads_a_table_with_its_units(self):
        import pyarrow

        table = pyarrow.table(self.run_of_discs.thermo())
        self.assertEqual(table.field("kinetic").metadata[b"unit"], b"energy")
        self.assertEqual(table.num_rows, 201)


class Lists(unittest.TestCase):
    def test_lists_are_complete(self):
        self.assertIn("hard-disks", stripmine.presets())
        names = [method["name"] for method in stripmine.methods()]
        self.assertEqual(names, ["lattice-md", "hard-disks", "langevin", "nbody"])
        for name in names:
            self.assertIn("count", [key["key"] for key in stripmine.keys(name)])
        with self.assertRaisesRegex(ValueError, "unknown method"):
            stripmine.keys("hard-discs")

    @unittest.skipUnless(scenes.command(), "there is no command `stripmine`: set STRIPMINE, or the path")
    def test_keys_match_the_command(self):
        for method in stripmine.methods():
            said = subprocess.run(
                [scenes.command(), "scene", "keys", method["name"], "--json"], check=True, capture_output=True
            )
            self.assertEqual(stripmine.keys(method["name"]), json.loads(said.stdout))

    def test_presets_survive_writing(self):
        for name in stripmine.presets():
            with self.subTest(name):
                scene = stripmine.scene(name)
                self.assertEqual(stripmine.scene(scene.toml()).toml(), scene.toml())
                self.assertIn(scene.method, repr(scene))
                count, dimensions = scene.particles().positions.shape
                self.assertEqual((len(scene.particles()), dimensions in (2, 3)), (count, True))

    def test_checks_report_expectations(self):
        said = stripmine.scene("pipe-small").check()
        self.assertEqual((said["scene"], said["method"]), ("pipe-small", "lattice-md"))
        self.assertGreater(said["memory"]["needed"], 0)
        self.assertTrue(said["step_limits"] and said["expected_time"]["seconds"] > 0)


if __name__ == "__main__":
    unittest.main()
