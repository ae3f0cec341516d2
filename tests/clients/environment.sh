#!/usr/bin/env bash
# Makes a virtual environment with the packages listed in some files, one name a line, and prints the path of its Python.
#
#   tests/clients/environment.sh ENVIRONMENT_FOLDER LIST...
#
# Needs Python 3 and, for missing packages, a network. A package that cannot be installed is left out, with the reason on
# standard error; if no environment can be made, prints the installed Python.
set -euo pipefail

if [[ $# -lt 2 ]]; then
    echo "usage: $0 ENVIRONMENT_FOLDER LIST..." >&2
    exit 2
fi
mkdir -p "$1"
environment=$(cd "$1" && pwd)
shift
python=${PYTHON:-python3}
if ! [[ -x $environment/bin/python ]] && ! "$python" -m venv "$environment" >&2; then
    echo "no virtual environment can be made; using $python and its packages" >&2
    command -v "$python"
    exit 0
fi
# One at a time, so that a failure does not stop the others.
while read -r package; do
    "$environment/bin/python" -m pip install --quiet --disable-pip-version-check "$package" >&2 ||
        echo "pip cannot install $package" >&2
done < <(cat "$@")
echo "$environment/bin/python"
