"""`__init__.pyi` matches the package: every name, and every parameter with its default."""

import ast
import inspect
import unittest
from pathlib import Path

import stripmine


def parameters(function):
    """Parameters of a function in the stub, without `self`: name, kind, and True with a default."""
    arguments = function.args
    plain = [(it.arg, "positional-only") for it in arguments.posonlyargs] + [(it.arg, "positional or keyword") for it in arguments.args]
    found = [(name, kind, at >= len(plain) - len(arguments.defaults)) for at, (name, kind) in enumerate(plain)]
    if arguments.vararg:
        found.append((arguments.vararg.arg, "variadic positional", False))
    for it, default in zip(arguments.kwonlyargs, arguments.kw_defaults):
        found.append((it.arg, "keyword-only", default is not None))
    if arguments.kwarg:
        found.append((arguments.kwarg.arg, "variadic keyword", False))
    return [it for it in found if it[0] != "self"]


def parameters_there(function):
    """Parameters of a function of the package, in the same form."""
    there = inspect.signature(function).parameters.values()
    found = [(it.name, it.kind.description, it.default is not it.empty) for it in there if it.name != "self"]
    return found


class Stub(unittest.TestCase):
    tree = ast.parse(Path(stripmine.__file__).with_name("__init__.pyi").read_text())

    def functions(self, body):
        return {it.name: it for it in body if isinstance(it, ast.FunctionDef)}

    def same(self, name, function, there):
        is_property = any(isinstance(it, ast.Name) and it.id == "property" for it in function.decorator_list)
        self.assertEqual(is_property, inspect.isdatadescriptor(there), name)
        if not is_property and not function.name.startswith("__"):
            self.assertEqual(parameters(function), parameters_there(there), name)

    def test_functions_match_the_package(self):
        functions = self.functions(self.tree.body)
        there = {name for name in stripmine.__all__ if inspect.isroutine(getattr(stripmine, name))}
        self.assertEqual(set(functions), there)
        for name, function in functions.items():
            self.same(name, function, getattr(stripmine, name))

    def test_classes_match_the_package(self):
        classes = [it for it in self.tree.body if isinstance(it, ast.ClassDef)]
        own = {name for name in stripmine.__all__ if getattr(getattr(stripmine, name), "__module__", "") == "stripmine"}
        own = {name for name in own if inspect.isclass(getattr(stripmine, name))}
        self.assertTrue({it.name for it in classes} <= own and len(classes) > 5, own)
        for kind in classes:
            functions, there = self.functions(kind.body), getattr(stripmine, kind.name)
            public = {name for name in vars(there) if not name.startswith("_")}
            self.assertEqual({name for name in functions if not name.startswith("_")}, public, kind.name)
            protocols = {name for name in vars(there) if name.startswith("__") and name not in vars(object)} - {"__module__", "__doc__"}
            for name in functions:
                self.assertTrue(hasattr(there, name), f"{kind.name}.{name}")
                self.same(f"{kind.name}.{name}", functions[name], getattr(there, name))
            self.assertTrue({"__len__", "__getitem__", "__contains__", "__iter__"} & protocols <= set(functions), kind.name)


if __name__ == "__main__":
    unittest.main()
