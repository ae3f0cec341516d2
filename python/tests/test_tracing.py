"""Traced functions: the numbers of numpy, in every execution; what cannot be traced is refused by name."""

import os
import pickle
import unittest

import numpy as np
import stripmine

EXECUTIONS = ["eager", "strip:1", "strip:64", "chained"]


def waves(length, step):
    return np.sin(step * np.arange(length))


class Tracing(unittest.TestCase):
    def test_arithmetic_equals_numpy(self):
        kernel = stripmine.trace(lambda x, y: (x * x + y * y).sqrt() / (3.0 - abs(y)) - 2 * x**3 + -y)
        x, y = waves(1001, 0.3), waves(1001, 0.7)
        expected = np.sqrt(x * x + y * y) / (3.0 - np.abs(y)) - 2 * (x * x * x) + -y
        for execution in EXECUTIONS:
            found = kernel.run(x, y, execution=execution)
            self.assertTrue(np.array_equal(found.view(np.uint64), expected.view(np.uint64)), execution)
        self.assertTrue(np.array_equal(kernel.run(y=y, x=x), expected))

    def test_choices_and_shifts_equal_numpy(self):
        def upwind(u, v):
            ahead = u.shift(1) - u
            behind = u - u.shift(-1)
            is_slow = (v < 0.5) & ~(v == 0.25) | (v >= 0.9)
            return {"slope": stripmine.where(is_slow, ahead, behind), "least": u.minimum(v).maximum(-0.5).trunc()}

        kernel = stripmine.trace(upwind)
        u, v = waves(300, 0.4), np.abs(waves(300, 0.9))
        inner = slice(1, -1)
        is_slow = (v < 0.5) & ~(v == 0.25) | (v >= 0.9)
        ahead, behind = np.roll(u, -1) - u, u - np.roll(u, 1)
        for execution in EXECUTIONS:
            found = kernel.run(u, v, execution=execution)
            self.assertEqual(list(found), ["slope", "least"])
            self.assertTrue(np.array_equal(found["slope"][inner], np.where(is_slow, ahead, behind)[inner]), execution)
            self.assertTrue(np.isnan(found["slope"][[0, -1]]).all())
            least = np.trunc(np.maximum(np.minimum(u, v), -0.5))
            self.assertTrue(np.array_equal(found["least"][inner], least[inner]), execution)

    def test_operations_are_counted_once(self):
        # Two loads, two products, a sum, a root and a store; x * x is recorded once.
        kernel = stripmine.trace(lambda x, y: (x * x + y * y).sqrt() + 0.0 * (x * x))
        counts = dict(zip(kernel.counts()["operation"], kernel.counts()["count"], strict=True))
        self.assertEqual(counts, {"ld": 2, "mul": 3, "add": 2, "sqrt": 1, "st": 1})
        self.assertEqual(kernel.nop, 9)
        self.assertIn("[x]", kernel.listing())
        self.assertIn("vfsqrt.v", kernel.rvv(lmul=2))
        self.assertEqual(pickle.loads(pickle.dumps(kernel)).listing(), kernel.listing())

    def test_numpy_functions_are_traced(self):
        kernel = stripmine.trace(lambda x: np.sqrt(np.abs(x)) + np.float64(1.5) * x)
        x = waves(50, 0.2)
        self.assertTrue(np.array_equal(kernel.run(x), np.sqrt(np.abs(x)) + 1.5 * x))

    @unittest.skipUnless("STRIPMINE" in os.environ, "needs the command")
    def test_clocks_follow_the_formula(self):
        kernel = stripmine.trace(lambda b, c: b + 3.0 * c)
        table = kernel.clocks("paper", 100)
        periods = dict(zip(table["clock"], table["clock_periods"], strict=True))
        # Two loads, a product, a sum and a store, each n + 20.
        self.assertEqual(periods["paper"], 5 * 120)
        with self.assertRaisesRegex(stripmine.Error, "unknown machine"):
            kernel.clocks("cray-9")

    def test_what_cannot_be_traced_is_refused(self):
        def branching(x):
            return x if x < 0 else -x

        for function, expected in [
            (branching, "branches on data"),
            (lambda x: [x], "list cannot be traced"),
            (lambda x: x + np.ones(3), "ndarray cannot be traced"),
            (lambda x: np.sin(x), "numpy.sin cannot be traced"),
            (lambda x: x**0.5, "power 0.5"),
            (lambda x: (x + 1).shift(1), "only inputs"),
            (lambda x: x.shift(0.5), "shift by 0.5"),
            (lambda x: x * float("nan"), "constant nan"),
            (lambda x: stripmine.where(True, x, x), "condition of where"),
            (lambda: 1.0, "positional parameters"),
            (lambda x: {"x": x}, "name of an input"),
            (lambda x: x < 0, "Predicate cannot be traced"),
            (lambda *x: x[0], "positional parameters"),
        ]:
            with self.assertRaisesRegex(stripmine.Error, expected):
                stripmine.trace(function)
        many = stripmine.trace
        with self.assertRaisesRegex(stripmine.Error, "limit is 16"):
            many(eval("lambda " + ", ".join(f"x{at}" for at in range(16)) + ": x0"))

    def test_wrong_arrays_are_refused(self):
        kernel = stripmine.trace(lambda x, y: x + y)
        x = waves(10, 1.0)
        for arrays, named, expected in [
            ([x], {}, "one array for each of x, y"),
            ([x, x, x], {}, "one array for each"),
            ([x], {"x": x}, "one array for each"),
            ([x, x[:9]], {}, "`y` has 9 elements, but `x` has 10"),
            ([x, x.astype(np.float32)], {}, "type float32"),
            ([x, x.reshape(2, 5)], {}, r"shape \(2, 5\)"),
        ]:
            with self.assertRaisesRegex(stripmine.Error, expected):
                kernel.run(*arrays, **named)
        with self.assertRaisesRegex(stripmine.Error, "unknown execution"):
            kernel.run(x, x, execution="strip:0")


if __name__ == "__main__":
    unittest.main()
