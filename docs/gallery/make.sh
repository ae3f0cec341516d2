#!/usr/bin/env bash
# Makes the pictures of docs/gallery.md with the commands of that page; the runs take 70 s of processor time.
#
#   docs/gallery/make.sh [FOLDER]
#
# Uses the release build of this checkout, or STRIPMINE. Keeps runs and all their pictures in FOLDER; without one they are deleted at the end.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
export STRIPMINE=${STRIPMINE:-$here/../../target/release/stripmine}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
folder=$(mkdir -p "${1:-$scratch}" && cd "${1:-$scratch}" && pwd)

# The commands name scenes relative to the root of the checkout, and runs relative to the current folder.
cd "$folder"
grep -E '^stripmine (run|plot) ' "$here/../gallery.md" | while read -r _ verb what rest; do
    case $verb in
        run) "$STRIPMINE" run "$here/../../$what" --quiet --overwrite $rest >/dev/null ;;
        plot)
            "$STRIPMINE" plot "$what" --quiet --overwrite $rest >/dev/null
            scene=$(basename "$what" .run)
            picture=$scene.plots/density-map.svg
            [[ -e $picture ]] || picture=$scene.plots/last-state.svg
            cp "$picture" "$here/$scene.svg"
            ;;
    esac
done
