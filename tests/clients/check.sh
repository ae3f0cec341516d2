#!/usr/bin/env bash
# Opens the files of a run with the programs its users have: numpy, pandas, ASE, MDAnalysis, gsd, freud, HOOMD, OVITO, LAMMPS.
#
#   tests/clients/check.sh RUN_FOLDER [ENVIRONMENT_FOLDER [REPORT_FOLDER]]
#
# With a report, its tables are read with pandas, too. With STRIPMINE, the program's path, what runs sum up of the structure is held
# against freud and MDAnalysis.
#
# Needs Python 3 and, for the first time, a network. The packages go into a virtual environment: in ENVIRONMENT_FOLDER,
# to be used again, or else in a temporary folder. A package that cannot be had is skipped, with the reason.
# Exits with 1 if a program refuses a file or reads other numbers from it, with 2 if it is called wrongly.
set -euo pipefail

if [[ $# -lt 1 || $# -gt 3 || ! -d $1 ]]; then
    echo "usage: $0 RUN_FOLDER [ENVIRONMENT_FOLDER [REPORT_FOLDER]]" >&2
    exit 2
fi
here=$(cd "$(dirname "$0")" && pwd)
if ! command -v "${PYTHON:-python3}" >/dev/null; then
    echo "SKIPPED (no ${PYTHON:-python3})"
    exit 0
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
python=$("$here/environment.sh" "${2:-$scratch}" "$here/open_run.packages")
# LAMMPS wants an MPI library.
environment=$(cd "$(dirname "$python")/.." && pwd)
export LD_LIBRARY_PATH=$environment/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
"$python" "$here/open_run.py" "$1"
if [[ -n ${3:-} ]]; then
    "$python" "$here/report_tables.py" "$3"
fi
if [[ -n ${STRIPMINE:-} ]]; then
    "$python" "$here/structure.py" "$STRIPMINE"
else
    echo "SKIPPED: structure against freud and MDAnalysis (no STRIPMINE)"
fi
