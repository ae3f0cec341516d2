#!/usr/bin/env bash
# Builds the program with MPI and runs scenes on 1 to 4 ranks: the same files to the byte, a rank that dies, a run that resumes on another number of
# ranks, a rank that cannot start, refusals.
#
#   tests/mpi/check.sh [ENVIRONMENT_FOLDER]
#
# Uses the MPI and libclang of the system, or else those of a virtual environment, which needs Python 3 and, the first time, a network. If neither
# is available, prints SKIPPED. Exits with 1 if a check fails.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

if ! command -v mpicc >/dev/null || ! command -v mpiexec >/dev/null; then
    python=$("$here/../clients/environment.sh" "${1:-$scratch/environment}" "$here/mpi.packages")
    environment=$(cd "$(dirname "$python")/.." && pwd)
    export PATH=$environment/bin:$PATH LD_LIBRARY_PATH=$environment/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
    LIBCLANG_PATH=$(dirname "$(find "$environment" -name 'libclang*.so*' | head -1)")
    export LIBCLANG_PATH
fi
if ! command -v mpicc >/dev/null || ! command -v mpiexec >/dev/null; then
    echo "SKIPPED (no mpicc and mpiexec)"
    exit 0
fi
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1

# Built like the tests, so that their dependencies are reused.
cargo test --manifest-path "$root/Cargo.toml" --workspace --features stripmine/mpi --locked --no-run --test ranks
stripmine=${CARGO_TARGET_DIR:-$root/target}/debug/stripmine
failed=0
bad() { echo "FAILED: $*"; failed=1; }
cd "$scratch"
# No process may wait for ever.
mpi() { timeout 300 mpiexec "$@"; }

# Lists, a lattice, and a bath, with rows, frames and checkpoints.
scenes=(
    "dense-gas --set particles.count=6000 --set run.steps=300 --set run.thermo_every=50 --set run.snapshot_every=100"
    "bench --set particles.count=6000 --set particles.packing_fraction=0.8 --set run.steps=300 --set run.thermo_every=50 --set run.snapshot_every=100"
    "langevin-dense --set domain.sides=[20.0,260.0] --set run.time=1.5 --set run.thermo_every=20"
)
for number in "${!scenes[@]}"; do
    read -ra scene <<<"${scenes[$number]}"
    "$stripmine" run "${scene[@]}" --quiet --threads 1 --out "alone-$number" >/dev/null
    for ranks in 2 3 4; do
        out=ranks-$number-$ranks
        mpi -n "$ranks" "$stripmine" run "${scene[@]}" --quiet --threads 1 --out "$out" >/dev/null ||
            bad "${scene[0]} on $ranks ranks"
        for file in thermo.csv trajectory.xyz; do
            cmp "alone-$number/$file" "$out/$file" || bad "${scene[0]} on $ranks ranks: $file"
        done
    done
    echo "${scene[0]}: the same rows and frames on 1 to 4 ranks"
done

# A rank that dies ends the others within seconds, and the run resumes on another number of ranks with the same bytes.
long=(bench --set particles.count=20000 --set run.steps=4000 --set run.thermo_every=100 --set run.checkpoint_every=200 --quiet --threads 1)
"$stripmine" run "${long[@]}" --out whole >/dev/null
timeout 300 mpiexec -n 3 "$stripmine" run "${long[@]}" --out killed >/dev/null 2>&1 &
launched=$!
for _ in $(seq 100); do
    [[ -e killed/run.checkpoint ]] && break
    sleep 0.1
done
pgrep -f "^$stripmine run bench .*--out killed" | tail -1 | xargs -r kill -9
for _ in $(seq 100); do
    kill -0 "$launched" 2>/dev/null || break
    sleep 0.1
done
if kill -0 "$launched" 2>/dev/null; then
    bad "ranks continue ten seconds after one of them was killed"
    kill -9 "$launched"
fi
wait "$launched" && bad "a run that lost a rank reports success"
mpi -n 2 "$stripmine" run "${long[@]}" --out killed --resume >/dev/null || bad "a resumption"
cmp whole/thermo.csv killed/thermo.csv || bad "a run resumed on another number of ranks"
echo "a rank that dies: the others end, and the run resumes on another number of ranks with the same rows"

# Seeds are distributed, and their joint result is that of one process.
seeds=(hard-disks --set run.time=5 --seeds 5 --quiet --threads 1)
"$stripmine" run "${seeds[@]}" --out one >/dev/null
mpi -n 3 "$stripmine" run "${seeds[@]}" --out three >/dev/null || bad "seeds"
for seed in 1 2 3 4 5; do
    cmp "one/seed-$seed/thermo.csv" "three/seed-$seed/thermo.csv" || bad "seed $seed"
done
# Refused seeds leave the joint result of earlier runs; it is removed while new ones run.
if mpi -n 3 "$stripmine" run "${seeds[@]}" --out three >/dev/null 2>&1; then bad "seeds are overwritten"; fi
[[ -e three/seeds.json ]] || bad "seeds.json is missing although nothing was run"
timeout 300 mpiexec -n 3 "$stripmine" run "${seeds[@]}" --set run.time=1e6 --out three --overwrite >/dev/null 2>&1 &
launched=$!
for _ in $(seq 100); do
    [[ -e three/seeds.json ]] || break
    sleep 0.1
done
[[ ! -e three/seeds.json ]] || bad "seeds.json of earlier runs stays next to new ones"
kill -0 "$launched" 2>/dev/null || bad "a long run with seeds ends at once"
kill "$launched" 2>/dev/null || true
wait "$launched" || true
echo "seeds: the same runs on 1 and 3 ranks"

# Studies and items are made jointly, with the same result as in one process.
study=(two-discs --over stiffness --size 4 --seeds 1 --budget 30 --quiet --threads 1)
"$stripmine" chart stability "${study[@]}" --out map-one >/dev/null
mpi -n 3 "$stripmine" chart stability "${study[@]}" --out map-three >/dev/null || bad "a map"
cmp map-one/host/stability/cells.csv map-three/host/stability/cells.csv || bad "the map of three processes"
items=(--only table --only mask --only misprints --quick --quiet --threads 1)
"$stripmine" reproduce "${items[@]}" --out items-one >/dev/null
mpi -n 3 "$stripmine" reproduce "${items[@]}" --out items-three >/dev/null || bad "items"
for item in table mask misprints; do
    diff -r -x provenance.json "items-one/$item" "items-three/$item" || bad "item $item of three processes"
done
echo "a map and three items: the same on 1 and 3 processes"

refused() {
    local word=$1 said
    shift
    if said=$("$@" 2>&1); then bad "$* is not refused"; fi
    [[ $said == *"$word"* ]] || bad "$* prints: $said"
}
refused "bands of rows" mpi -n 4 "$stripmine" run dense-gas --quiet --out many
refused "one after the other" mpi -n 2 "$stripmine" run hard-disks --quiet --out events
refused "--ranks was given" mpi -n 2 "$stripmine" run dense-gas --quiet --ranks 2 --out twice
echo "refused: too many ranks, hard discs, ranks twice"

# Rank 1 of three behaves differently: all end with one exit code, and one message names the rank.
one_differs() {
    local code=$1 words=$2 first=$3 others=$4 said status=0
    cat >differs.sh <<EOF
#!/bin/sh
rank=\${PMI_RANK:-\$OMPI_COMM_WORLD_RANK}
if [ "\$rank" = 1 ]; then $first; fi
exec "$stripmine" $others --quiet --threads 1
EOF
    chmod +x differs.sh
    said=$(timeout 60 mpiexec -n 3 ./differs.sh 2>&1) || status=$?
    [[ $status == "$code" && $said == *"error: rank 1"*"$words"* && $(grep -c "error:" <<<"$said") == 1 ]] ||
        bad "rank 1: $first; the others: $others: exit code $status instead of $code, and: $said"
}
program="exec \"$stripmine\""
limit="ulimit -v 300000"
gas="dense-gas --set particles.count=200000 --set run.steps=10"
one_differs 4 "differs from rank 0" "$program run dense-gas --set particles.seed=2 --quiet --out o1" "run dense-gas --out o1"
one_differs 3 "none.toml" "$program run none.toml --quiet --out o2" "run dense-gas --out o2"
one_differs 2 "--nonsense" "$program run dense-gas --nonsense" "run dense-gas --out o3"
one_differs 4 "differs from rank 0" "$program table --quiet" "run dense-gas --out o4"
one_differs 3 "ulimit -v" "$limit" "run $gas --out o5"
one_differs 3 "none.toml" "$program run none.toml --seeds 3 --quiet --out o6" "run hard-disks --seeds 3 --set run.time=1 --out o6"
one_differs 4 "differs from rank 0" "$program run hard-disks --seeds 4 --quiet --out o7" "run hard-disks --seeds 3 --set run.time=1 --out o7"
one_differs 2 "0.907" "$program bench lattice --packing-fraction 2 --quiet" "bench lattice --steps 100 --repeats 1 --particles 6000"
one_differs 3 "ulimit -v" "$limit" "bench lattice --steps 10 --repeats 1 --particles 200000"
one_differs 3 "none.toml" "$program chart stability none.toml --out o8" "chart stability two-discs --size 3 --seeds 1 --budget 5 --out o8"
one_differs 4 "differs from rank 0" "$program reproduce --only mask --out o9" "reproduce --only table --out o9"
# A rank that joins no other leaves them waiting, and they report it.
said=$(timeout 40 mpiexec -n 3 sh -c "[ \"\${PMI_RANK:-\$OMPI_COMM_WORLD_RANK}\" = 1 ] && exec $stripmine --version; exec $stripmine run dense-gas --out o10" 2>&1) || true
[[ $said == *"rank 0 of 3 has waited"* ]] || bad "a rank with --version: $said"
for out in o[1-9]*; do
    [[ ! -e $out/thermo.csv ]] || bad "$out: a run that could not start has written rows"
done
echo "a rank that cannot start, or behaves differently: all end, and the message names it"
exit $failed
