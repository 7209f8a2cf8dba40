#!/usr/bin/env bash
# Compares full loads of .vdb files by Tyndall with those by OpenVDB (its Python module), in turns on one machine.
#
#   benchmarks/read_speed.sh FILE.vdb... > benchmarks/runs/DATE-CPU/read_speed.txt
#
# RUNS (default 9) loads a turn, TURNS (default 5) turns. Without the Python module only Tyndall is timed.
set -euo pipefail
[ $# -gt 0 ] || { echo "usage: benchmarks/read_speed.sh FILE.vdb..." >&2; exit 2; }

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
runs=${RUNS:-9}
turns=${TURNS:-5}

cargo build --quiet --release --locked --manifest-path "$here/../Cargo.toml" -p tyndall-volumes --example read_speed
target=$(cargo metadata --no-deps --locked --offline --format-version 1 --manifest-path "$here/../Cargo.toml" |
    sed 's/.*"target_directory":"\([^"]*\)".*/\1/')
tyndall=$target/release/examples/read_speed

python=
for candidate in python3 /usr/bin/python3; do
    if version=$("$candidate" "$here/read_speed_openvdb.py" --version 2>/dev/null); then
        python=$candidate
        break
    fi
done

echo "# full loads, $turns turns of $runs runs each"
echo "# cpu: $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo 2>/dev/null | head -1), $(nproc 2>/dev/null || echo '?') cores, load $(cut -d' ' -f1 /proc/loadavg 2>/dev/null || echo '?')"
echo "# tyndall-volumes: commit $(git -C "$here" rev-parse --short HEAD), $(rustc --version)"
echo "# openvdb: ${version:-not found}"
echo "# reader file runs least_ms median_ms active_voxels"

raw=$(mktemp)
trap 'rm -f "$raw"' EXIT
for _ in $(seq "$turns"); do
    for file in "$@"; do
        "$tyndall" --runs "$runs" "$file" | sed 's/^/tyndall /'
        RAYON_NUM_THREADS=1 "$tyndall" --runs "$runs" "$file" | sed 's/^/tyndall-1-thread /'
        [ -z "$python" ] || "$python" "$here/read_speed_openvdb.py" --runs "$runs" "$file" | sed 's/^/openvdb /'
    done
done | tee "$raw"

echo "#"
echo "# least of all turns [ms]: file tyndall tyndall-1-thread openvdb openvdb/tyndall openvdb/tyndall-1-thread"
awk '
    { key = $1 SUBSEP $2; files[$2] }
    !(key in least) || $4 < least[key] { least[key] = $4 }
    END {
        for (file in files) {
            a = least["tyndall", file]; b = least["tyndall-1-thread", file]; c = least["openvdb", file]
            if (c) printf "# %s %s %s %s %.2f %.2f\n", file, a, b, c, c / a, c / b
            else printf "# %s %s %s - - -\n", file, a, b
        }
    }' "$raw"
