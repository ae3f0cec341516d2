#!/usr/bin/env bash
# Opens the files of a run with the programs their users have: numpy, pandas, ASE, MDAnalysis, gsd, freud, HOOMD, OVITO, LAMMPS.
#
#   tests/clients/check.sh RUN_FOLDER [ENVIRONMENT_FOLDER [REPORT_FOLDER]]
#
# With a report, also reads its tables with pandas. With STRIPMINE, the program's path, also compares structure functions
# with freud and MDAnalysis.
#
# Needs Python 3 and, the first time, a network. The packages are installed in a virtual environment: in ENVIRONMENT_FOLDER,
# for reuse, or else in a temporary folder. A package that cannot be installed is skipped, with the reason.
# Exits with 1 if a program rejects a file or reads other numbers from it, with 2 if it is called wrongly.
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
# LAMMPS needs an MPI library.
environment=$(cd "$(dirname "$python")/.." && pwd)
export LD_LIBRARY_PATH=$environment/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
"$python" "$here/open_run.py" "$1"
if [[ -n ${3:-} ]]; then
    "$python" "$here/report_tables.py" "$3"
fi
if [[ -n ${STRIPMINE:-} ]]; then
    "$python" "$here/structure.py" "$STRIPMINE"
else
    echo "SKIPPED: structure compared with freud and MDAnalysis (no STRIPMINE)"
fi
