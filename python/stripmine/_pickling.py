"""How objects go to other processes, and are copied: a scene as its TOML, a run as its folder, particles and frames as their arrays.
Importing this module registers it with `pickle` and `copy`."""

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
            "a run in a temporary folder goes with this process: run the scene into a folder, scene.run(out), and hand that run over"
        )
    return _run, (run.folder,)


def _refusing(message):
    def refuse(_):
        raise TypeError(message)

    return refuse


def register():
    """Tells `copyreg`, which both modules ask."""
    copyreg.pickle(_stripmine.Scene, lambda scene: (_scene, (scene.toml(),)))
    copyreg.pickle(_stripmine.Run, _reduced_run)
    copyreg.pickle(_stripmine.Particles, _by_attributes(_particles, _stripmine._attributes_of_particles))
    copyreg.pickle(_stripmine.Frame, _by_attributes(_frame, _stripmine._attributes_of_a_frame))
    for kind, message in (
        (_stripmine.Simulation, "a simulation under way cannot be handed over or copied: hand over the scene, and start it there"),
        (_stripmine.Frames, "an open trajectory cannot be handed over or copied: hand over the run, or list(run.frames())"),
        (_stripmine.Table, "a table cannot be handed over or copied: hand over table.to_pandas(), or its columns, table[name]"),
    ):
        copyreg.pickle(kind, _refusing(message))
