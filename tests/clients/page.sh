#!/usr/bin/env bash
# Opens the page of a reproduction in a browser without a window and uses it as a reader would.
#
#   tests/clients/page.sh PAGE.html [ENVIRONMENT_FOLDER [PICTURES_FOLDER]]
#
# Needs Python 3, Chromium, and, the first time, a network for the package that drives it; skipped if one of them is
# missing. The package is installed in a virtual environment: in ENVIRONMENT_FOLDER, for reuse, or else in a temporary
# folder.
set -euo pipefail

if [[ $# -lt 1 || $# -gt 3 || ! -f $1 ]]; then
    echo "usage: $0 PAGE.html [ENVIRONMENT_FOLDER [PICTURES_FOLDER]]" >&2
    exit 2
fi
here=$(cd "$(dirname "$0")" && pwd)
if ! command -v "${PYTHON:-python3}" >/dev/null; then
    echo "SKIPPED (no ${PYTHON:-python3})"
    exit 0
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
python=$("$here/environment.sh" "${2:-$scratch}" "$here/page.packages")
"$python" "$here/page.py" "$1" "${@:3}"
