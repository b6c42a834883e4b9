#!/usr/bin/env bash
# The same bytes from many runs: every kind of answer, RUNS times on one core and RUNS times on all, by SHA-256.
# usage: tests/same_bytes.sh [RUNS]        (20 if not given; SIDC names the program, target/release/sidc if not given)
set -euo pipefail
cd "$(dirname "$0")/.."
runs=${1:-20}
sidc=$(realpath "${SIDC:-target/release/sidc}")
root=$PWD
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# One run of everything in a folder of its own; prints a line "SHA-256  what" for each output.
once() {
    local place=$folder/run prefix=("$@")
    rm -rf "$place" && mkdir "$place"
    cp "$root"/models/*.sid "$root"/models/data/*.csv "$place"
    cd "$place"
    say() {
        local name=$1
        shift
        local status=0
        "${prefix[@]}" "$sidc" "$@" >"$name.out" 2>"$name.err" || status=$?
        [ "$status" = 0 ] || [ "$status" = 3 ] || { cat "$name.err" >&2; exit 1; }
    }
    say clean identify lorenz.sid lorenz.csv --path --evidence --verify -o clean.json
    say noisy identify lotka_volterra.sid lotka_volterra.csv -o noisy.json
    say joint identify fitzhugh_nagumo.sid fitzhugh_nagumo.csv --method joint --window=..20 -o joint.json
    say weak identify lorenz.sid lorenz.csv --method weak -o weak.json
    say large identify pendulum.sid pendulum.csv --verify -o large.json
    say clarabel identify lorenz.sid lorenz.csv --solver clarabel -o clarabel.json
    say tied identify two_carts.sid two_carts.csv -o tied.json
    say run simulate clean.json lorenz.csv -o run.csv
    say report report clean.json lorenz.csv -o report.html
    say smooth smooth fitzhugh_nagumo.sid fitzhugh_nagumo.csv -o smooth.csv
    for target in text latex sympy rust c python matlab; do
        say "$target" export large.json --to "$target"
    done
    sha256sum -- *.out *.err *.json *.html run.csv smooth.csv
    cd "$root"
}

once >"$folder/first"
echo "$(wc -l <"$folder/first") outputs, $(nproc) cores"
different=0
for ((k = 1; k <= runs; k++)); do
    once taskset -c 0 | cmp -s - "$folder/first" || { different=$((different + 1)); echo "run $k on one core differs"; }
    once env | cmp -s - "$folder/first" || { different=$((different + 1)); echo "run $k on all cores differs"; }
done
echo "$((2 * runs)) runs, $different different"
[ "$different" = 0 ]
