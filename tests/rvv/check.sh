#!/usr/bin/env bash
# Executes emitted programs on a vector processor of others: assembled by binutils, run by QEMU, compared bit by bit.
# Installs nothing; says SKIPPED if a tool is missing. STRIPMINE is the program.
set -euo pipefail
stripmine=${STRIPMINE:-target/debug/stripmine}
for tool in riscv64-linux-gnu-as riscv64-linux-gnu-ld qemu-riscv64; do
    if ! command -v "$tool" >/dev/null; then
        echo "SKIPPED: $tool is missing; install binutils-riscv64-linux-gnu and qemu-user"
        exit 0
    fi
done
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# Scenes: name of the folder, preset, overrides.
while read -r name preset overrides; do
    sets=()
    for override in $overrides; do sets+=(--set "$override"); done
    for lmul in 1 2 4 8; do
        "$stripmine" emit "$preset" "${sets[@]}" --isa rvv --lmul "$lmul" --steps 3 --out "$scratch/$name-$lmul" --quiet
        for vlen in 128 256 512 1024; do
            printf '%s, LMUL %s, VLEN %s: ' "$name" "$lmul" "$vlen"
            VLEN=$vlen sh "$scratch/$name-$lmul/run.sh"
        done
    done
done <<'SCENES'
grains bench particles.count=60
walls pipe-small
linear bench particles.count=60 law.kind=linear
printed dense-gas-printed particles.count=60
lennard-jones langevin-dense particles.count=60 domain.sides=[10.0,11.0]
gravity plummer particles.count=37
SCENES

# A folder with a file of others is refused.
mkdir "$scratch/other"
echo own >"$scratch/other/notes.txt"
if "$stripmine" emit bench --isa rvv --out "$scratch/other" --quiet; then
    echo "a folder with other files was written to"
    exit 1
fi
# So is a precision without code.
if "$stripmine" emit bench --set machine.precision=f32 --set machine.engine=programs --isa rvv --out "$scratch/single" --quiet; then
    echo "f32 has no vector code, but was emitted"
    exit 1
fi
