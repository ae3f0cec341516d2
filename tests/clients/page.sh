#!/usr/bin/env bash
# Opens the page of a reproduction in a browser without a window and uses it as a reader would.
#
#   tests/clients/page.sh PAGE.html [PICTURES_FOLDER]
#
# Needs Python 3, Chromium, and a network for the package that drives it; skipped where one of them cannot be had.
set -euo pipefail

if [[ $# -lt 1 || $# -gt 2 || ! -f $1 ]]; then
    echo "usage: $0 PAGE.html [PICTURES_FOLDER]" >&2
    exit 2
fi
here=$(cd "$(dirname "$0")" && pwd)
python=${PYTHON:-python3}
if ! command -v "$python" >/dev/null; then
    echo "SKIPPED (no $python)"
    exit 0
fi
environment=$(mktemp -d)
trap 'rm -rf "$environment"' EXIT
if "$python" -m venv "$environment" >&2; then
    python=$environment/bin/python
    "$python" -m pip install --quiet --disable-pip-version-check playwright >&2 || echo "pip cannot install playwright" >&2
fi
"$python" "$here/page.py" "$@"
