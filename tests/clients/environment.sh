#!/usr/bin/env bash
# Makes a virtual environment with the packages of some lists, one name a line, and prints the Python to be called.
#
#   tests/clients/environment.sh ENVIRONMENT_FOLDER LIST...
#
# Needs Python 3 and, for what is not there yet, a network. A package that cannot be had is left out, with the reason on
# standard error; where no environment can be made, the Python that is there is printed.
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
    echo "no virtual environment can be made; going on with $python and what it has" >&2
    command -v "$python"
    exit 0
fi
# One at a time, so that one that cannot be had does not keep the others away.
while read -r package; do
    "$environment/bin/python" -m pip install --quiet --disable-pip-version-check "$package" >&2 ||
        echo "pip cannot install $package" >&2
done < <(cat "$@")
echo "$environment/bin/python"
