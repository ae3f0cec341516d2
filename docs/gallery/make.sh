#!/usr/bin/env bash
# Makes the pictures of docs/gallery.md by the commands that stand there; the runs take 70 s of processor time.
#
#   docs/gallery/make.sh [FOLDER]
#
# The program is the release build of this checkout, or STRIPMINE. Runs and all their pictures are left in FOLDER, and go with it where none is given.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
export STRIPMINE=${STRIPMINE:-$here/../../target/release/stripmine}
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
folder=$(mkdir -p "${1:-$scratch}" && cd "${1:-$scratch}" && pwd)

# The commands name scenes from the root of the checkout, and runs from where they stand.
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
