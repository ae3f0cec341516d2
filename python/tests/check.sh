#!/usr/bin/env bash
# Builds and installs the package for Python, and runs its tests and notebooks.
#
#   python/tests/check.sh [ENVIRONMENT_FOLDER]
#
# Needs Python 3.11 and, for what is not there yet, a network; says SKIPPED where the package cannot be built for want of these. Tests that hold it
# against the command need STRIPMINE, the command's path. Exits with 1 if anything is not as it should be.
set -euo pipefail
here=$(cd "$(dirname "$0")/.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

python=$("$here/../tests/clients/environment.sh" "${1:-$scratch/environment}" "$here/tests/python.packages")
if ! "$python" -c 'import maturin, numpy' 2>/dev/null; then
    echo "SKIPPED: the package for Python (no maturin or numpy)"
    exit 0
fi
PATH=$(dirname "$python"):$PATH "$python" -m pip install --quiet --disable-pip-version-check --no-build-isolation "$here"
# Not beside the sources of the package: a folder named as it is would be imported in its place, without its compiled part.
cp -r "$here/tests" "$here/notebooks" "$scratch"
cd "$scratch"
"$python" -m unittest discover -t . -s tests
if "$python" -c 'import nbclient, ipykernel, matplotlib' 2>/dev/null; then
    for notebook in notebooks/*.ipynb; do
        timeout 300 "$python" -m jupyter execute --output="$scratch/$(basename "$notebook")" "$notebook"
    done
else
    echo "SKIPPED: notebooks (no nbclient, ipykernel or matplotlib)"
fi
