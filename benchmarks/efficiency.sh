#!/usr/bin/env bash
# The efficiency of the fast engine: 1 / ((relMSE - own noise of the reference) * seconds of rendering).
#
#   benchmarks/efficiency.sh [SPP [SEEDS]]      default: 16 samples a pixel, 3 seeds
#
# The references are 256x256 pictures by another renderer; their own noise is part of every relMSE measured against
# them and is subtracted. `wall` is the time of the whole command: loading, building, rendering, writing. Run it on a
# machine that does nothing else. Other options of `tyndall render` go into OPTIONS, as in
#   OPTIONS="--threads 1" benchmarks/efficiency.sh 16
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
spp=${1:-16}
seeds=${2:-3}
references=$here/../../shared/bench/references
[ -d "$references" ] || { echo "benchmarks/efficiency.sh: the reference pictures are not there: ../shared/bench/references beside the checkout" >&2; exit 1; }

cargo build --quiet --release --locked --manifest-path "$here/../Cargo.toml" -p tyndall
target=$(cargo metadata --no-deps --locked --offline --format-version 1 --manifest-path "$here/../Cargo.toml" |
    sed 's/.*"target_directory":"\([^"]*\)".*/\1/')
tyndall=$target/release/tyndall

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# number FILE KEY: the first number that KEY has in a JSON file.
number() { grep -o "\"$2\": *-\{0,1\}[0-9][0-9.eE+-]*" "$1" | head -1 | sed 's/.*: *//'; }

# measure SCENE REFERENCE OWN_NOISE SEED
measure() {
    local scene=$1 reference=$2 noise=$3 seed=$4 start wall
    start=$(date +%s.%N)
    # shellcheck disable=SC2086
    "$tyndall" render "$here/scenes/$scene.toml" --spp "$spp" --seed "$seed" --progress none ${OPTIONS:-} \
        -o "$folder/a.exr" -o "$folder/a.json" 2>/dev/null
    wall=$(awk -v start="$start" -v end="$(date +%s.%N)" 'BEGIN { print end - start }')
    "$tyndall" diff "$folder/a.exr" "$references/$reference" --json > "$folder/diff.json"
    awk -v scene="$scene" -v spp="$spp" -v seed="$seed" -v noise="$noise" -v wall="$wall" \
        -v seconds="$(number "$folder/a.json" seconds)" \
        -v relmse="$(number "$folder/diff.json" relmse)" \
        -v trimmed="$(number "$folder/diff.json" relmse_trimmed)" \
        -v z="$(sed 's/.*"z":\[\([^]]*\)\].*/\1/' "$folder/diff.json")" '
        function efficiency(error) {
            return error > noise ? sprintf("%.3g", 1 / ((error - noise) * seconds)) : "too-many-samples-for-this-reference"
        }
        BEGIN {
            split(z, c, ",")
            printf "%s %d %d %.2f %.2f %.5f %.5f %s %s %.1f,%.1f,%.1f\n", scene, spp, seed, seconds, wall,
                relmse, trimmed, efficiency(relmse), efficiency(trimmed), c[1], c[2], c[3]
        }'
}

echo "# cpu: $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo 2>/dev/null | head -1), $(nproc 2>/dev/null || echo '?') cores, load $(cut -d' ' -f1 /proc/loadavg 2>/dev/null || echo '?')"
echo "# $("$tyndall" --version), commit $(git -C "$here" rev-parse --short HEAD), $(rustc --version)${OPTIONS:+, options $OPTIONS}"
echo "# scene spp seed seconds wall relmse relmse_trimmed efficiency efficiency_trimmed z_of_the_means"
for seed in $(seq "$seeds"); do
    measure A_cloud A.exr 8.2e-4 "$seed"
    measure G_wdas G.exr 1.2e-3 "$seed"
done | tee "$folder/lines"
awk '
    { n[$1]++; error[$1] += $6; seconds[$1] += $4 }
    END {
        for (s in n) {
            e = error[s] / n[s]; t = seconds[s] / n[s]; noise = s ~ /^A/ ? 8.2e-4 : 1.2e-3
            printf "# mean of %s: relmse %.5f, %.2f s, efficiency %s\n", s, e, t, (e > noise ? sprintf("%.3g", 1 / ((e - noise) * t)) : "-")
        }
    }' "$folder/lines"
