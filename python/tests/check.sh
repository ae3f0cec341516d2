#!/usr/bin/env bash
# Builds and installs the package for Python, and runs its tests and notebooks.
#
#   python/tests/check.sh [ENVIRONMENT_FOLDER]
#
# Needs Python 3.11 and, for missing packages, a network; prints SKIPPED if the package cannot be built without them. Tests that compare it
# with the command need its path in STRIPMINE. Exits with 1 if anything fails.
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
# The tests are copied, since beside the sources the source folder would be imported instead of the installed package.
cp -r "$here/tests" "$here/notebooks" "$scratch"
cp -r "$here/../tests/io/start_files" "$scratch/tests"
cd "$scratch"
"$python" -m unittest discover -t . -s tests
if "$python" -c 'import nbclient, ipykernel, matplotlib' 2>/dev/null; then
    for notebook in notebooks/*.ipynb; do
        # Its clocks are those of the command.
        if [[ $notebook == *own_kernel* && -z ${STRIPMINE:-} ]] && ! command -v stripmine >/dev/null; then
            echo "SKIPPED: $notebook (no command stripmine)"
            continue
        fi
        timeout 300 "$python" -m jupyter execute --output="$scratch/$(basename "$notebook")" "$notebook"
    done
else
    echo "SKIPPED: notebooks (no nbclient, ipykernel or matplotlib)"
fi
