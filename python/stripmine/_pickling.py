"""Pickling and copying: a scene as its TOML, a run as its folder, particles and frames as their arrays."""

import copyreg

from . import _stripmine

def _scene(text):
    return _stripmine.scene(text)


def _run(folder):
    return _stripmine.read(folder)


def _particles(*arrays):
    return _stripmine._particles(*arrays)


def _frame(*values):
    return _stripmine._frame(*values)


def _by_attributes(make, names):
    return lambda it: (make, tuple(getattr(it, name) for name in names))


def _reduced_run(run):
    if run._is_temporary:
        raise TypeError(
            "a run in a temporary folder cannot be pickled or copied: use scene.run(out) with a folder, and pass that run"
        )
    return _run, (run.folder,)


def _refusing(message):
    def refuse(_):
        raise TypeError(message)

    return refuse


def register():
    """Registers the classes with `copyreg`, which pickle and copy use."""
    copyreg.pickle(_stripmine.Scene, lambda scene: (_scene, (scene.toml(),)))
    copyreg.pickle(_stripmine.Run, _reduced_run)
    copyreg.pickle(_stripmine.Particles, _by_attributes(_particles, _stripmine._attributes_of_particles))
    copyreg.pickle(_stripmine.Frame, _by_attributes(_frame, _stripmine._attributes_of_a_frame))
    for kind, message in (
        (_stripmine.Simulation, "a running simulation cannot be pickled or copied: pass the scene, and start it there, or a folder of save()"),
        (_stripmine.Frames, "an open trajectory cannot be pickled or copied: pass the run, or list(run.frames())"),
        (_stripmine.Table, "a table cannot be pickled or copied: pass table.to_pandas(), or its columns, table[name]"),
    ):
        copyreg.pickle(kind, _refusing(message))
