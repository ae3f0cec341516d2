"""2D particle dynamics: granular discs, hard discs, Langevin dynamics, and gravitating bodies.

A scene defines a simulation. Run it as a whole, or advance it step by step:

    import stripmine
    scene = stripmine.scene("hard-disks", {"particles.count": 400})
    simulation = scene.start()
    simulation.advance(time=10.0)
    simulation.observe()["compressibility"]

Quantities are in the units of the scene; dimensions such as "length" or "energy" are given with each quantity.
"""

import os as _os

from . import _pickling, _studies
from ._errors import BusyError, Error, Mistake, RunError, SceneError, SimulationError
from ._stripmine import (
    Frame,
    Frames,
    Particles,
    Run,
    Scene,
    Simulation,
    Table,
    __version__,
    _forked,
    average,
    keys,
    methods,
    presets,
    read,
    scene,
)
from ._tracing import Kernel, Vector, trace, where

__all__ = [
    "BusyError",
    "Error",
    "Frame",
    "Frames",
    "Kernel",
    "Mistake",
    "Particles",
    "Run",
    "RunError",
    "Scene",
    "SceneError",
    "Simulation",
    "SimulationError",
    "Table",
    "Vector",
    "__version__",
    "average",
    "keys",
    "methods",
    "presets",
    "read",
    "scene",
    "trace",
    "where",
]

_pickling.register()
_studies.register()

# Threads do not survive a fork: a child of a process that has computed gets an error instead of waiting forever.
if hasattr(_os, "register_at_fork"):
    _os.register_at_fork(after_in_child=_forked)
