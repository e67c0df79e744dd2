#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# relume study: combinations, exponents, bias found and not found, what is written, refusals, stopping.
#
# usage: study.sh RELUME
set -u
relume=$1
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"

scene=$root/data/scenes/cornell-box/scene.xml
out_folder=$folder/study

# holds JSON EXPRESSION: a Python expression about the study s and its points p
holds() {
    python3 - "$@" <<'END' || fail "not so: $2"
import json, sys
s = json.load(open(sys.argv[1]))
p = s["points"]
sys.exit(0 if eval(sys.argv[2]) else 1)
END
}

# Wrong usage: 2, with what was found; nothing is rendered.
expect 2 "$relume" study "$scene" -o "$out_folder"
contains "$err" "--vary"
for bad in spp spp= =4 spp=4,4 spp=0 spp=many integrator=pth sampler=sobl; do
    expect 2 "$relume" study "$scene" --vary "$bad" -o "$out_folder"
    contains "$err" "${bad%%=*}"
done
contains "$err" "sobol"
expect 2 "$relume" study "$scene" --vary max-depht=2 -o "$out_folder"
contains "$err" "max_depth"
for bad in relmse relmse=x rmse=1 relmse=0; do
    expect 2 "$relume" study "$scene" --vary spp=1 --target "$bad" -o "$out_folder"
    contains "$err" "$bad"
done
expect 1 "$relume" study "$scene" --vary spp=1 -o "$folder/no/such"
contains "$err" "$folder/no/such"
expect 1 "$relume" study "$folder/none.xml" --vary spp=1 -o "$out_folder"
expect 0 "$relume" study --help
contains "$out" "max-depth"

# All combinations; a setting that a method lacks is tried once.
expect 0 "$relume" study "$scene" --size 12x12 --vary integrator=path,direct \
    --vary emitter-samples=1,2 --vary spp=2 --repeat 2 --reference-spp 64 -q -o "$folder/methods"
holds "$folder/methods/study.json" 'len(p) == 3'
holds "$folder/methods/study.json" \
    '[q["settings"].get("emitter_samples") for q in p] == [None, "1", "2"]'
holds "$folder/methods/study.json" 'all(q["relmse"]["error"] is None for q in p)' # two runs only
holds "$folder/methods/study.json" 'len({r["seed"] for q in p for r in q["runs"]}) == 6'

# A limit of indirect light takes away what it says: an intended bias is told as bias. Without one an
# interval misses 0 on that side in 2.5 % of the studies; seeds are fixed.
expect 0 "$relume" study "$scene" --size 12x12 --vary sampler=sobol --vary clamp=0,1e-3 \
    --vary adaptive=false,true --vary spp=64 --reference-spp 256 --repeat 3 -q -o "$folder/clamp"
holds "$folder/clamp/study.json" 'len(p) == 4'
holds "$folder/clamp/study.json" \
    'all((q["bias2"]["low"] > 0) == (q["settings"]["clamp"] != "0") for q in p)'

# As many samples for each setting.
expect 0 "$relume" study "$scene" --size 8x8 --vary spp=2,4,8 --even --repeat 2 --reference-spp 64 -q \
    -o "$folder/even"
holds "$folder/even/study.json" '[len(q["runs"]) for q in p] == [8, 4, 2]'

# A scene of known error: independent samples have the exponent -1. Its standard error here is about
# 0.03 (five runs of 576 pixels each, four points): 0.2 is far outside.
expect 0 "$relume" study "$scene" --size 24x24 --vary sampler=independent --vary spp=4,16,64,256 \
    --vary rr-depth=1000 --reference-spp 2048 --target variance=0.02 --json -o "$out_folder"
holds "$out_folder/study.json" 'abs(s["series"][0]["exponents"]["variance"]["slope"] + 1) < 0.2'
holds "$out_folder/study.json" 'all(q["variance"]["low"] < q["variance"]["value"] for q in p)'
# No bias: its intervals miss 0 in under 5 % of the studies; all four do not miss by twice as much.
holds "$out_folder/study.json" \
    'all(abs(q["bias2"]["value"]) < 6 * q["bias2"]["error"] for q in p)'
holds "$out_folder/study.json" 'abs(p[0]["bias2"]["value"]) < 0.1 * p[0]["variance"]["value"]'
holds "$out_folder/study.json" 's["target"]["point"] == min(
    (q["seconds"], i) for i, q in enumerate(p) if q["variance"]["value"] <= 0.02)[1]'
holds "$out_folder/study.json" 'any(q["front_seconds"] for q in p)'
contains "$out" '"exponents"'

# What is written stands alone: well-formed drawings, nothing from elsewhere.
python3 - "$out_folder" <<'END' || fail "page or table"
import csv, re, sys, xml.dom.minidom
folder = sys.argv[1]
for name in ("spp", "seconds", "memory"):
    xml.dom.minidom.parse(f"{folder}/error-{name}.svg")
page = open(f"{folder}/study.html", encoding="utf-8").read()
drawings = re.findall(r"<svg.*?</svg>", page, re.S)
assert len(drawings) == 3
for drawing in drawings:
    xml.dom.minidom.parseString(drawing)
assert "<script" not in page and not re.search(r"(src|href)=\"(?!data:)", page)
assert page.count("data:image/png;base64,") == 1 + 2 * 4
rows = list(csv.DictReader(open(f"{folder}/study.csv")))
assert [r["spp"] for r in rows] == ["4", "16", "64", "256"]
assert all(float(r["relmse_low"]) < float(r["relmse"]) < float(r["relmse_high"]) for r in rows)
END

# Short paths are biased: squared bias far outside its interval, and no less error for more samples.
# The reference is the file that the study before has left.
expect 3 "$relume" study "$scene" --size 24x24 --vary max-depth=2 --vary spp=16,64 \
    --reference "$out_folder/reference.exr" --target relmse=1e-6 -o "$folder/bias"
holds "$folder/bias/study.json" 'all(q["bias2"]["low"] > 0.05 for q in p)'
holds "$folder/bias/study.json" 'all(abs(q["relmse"]["value"] - q["bias2"]["value"] - q["variance"]["value"]) < 1e-9 for q in p)'
contains "$out" "No setting"
expect 1 "$relume" study "$scene" --size 12x12 --vary spp=1 --reference "$out_folder/reference.exr" \
    -o "$folder/bias"
contains "$err" "24 x 24"

# The same seed gives the same numbers.
for i in 1 2; do
    expect 0 "$relume" study "$scene" --size 12x12 --vary spp=2,4 --repeat 3 --reference-spp 64 \
        --threads $i -q -o "$folder/again$i"
    python3 -c 'import json, sys
print([q["relmse"]["value"] for q in json.load(open(sys.argv[1]))["points"]])' \
        "$folder/again$i/study.json" >"$folder/again$i.txt"
done
cmp -s "$folder/again1.txt" "$folder/again2.txt" || fail "threads change the numbers"

# The storage of a tensor: no noise, errors within each budget, and the bytes that it takes.
tensor=$(dirname "$relume")/../tests/polynomial.safetensors # the build makes it
expect 0 "$relume" edit "$tensor" -o "$folder/tensor.exr" -q
size=$("$relume" info "$folder/tensor.exr" | awk '/^width:/ { w = $2 } /^height:/ { print w "x" $2; exit }')
expect 0 "$relume" study "$scene" --size "$size" --vary integrator=stored --vary "filename=$tensor" \
    --vary budget=1e-3,1e-4,1e-6 --vary spp=1 --repeat 2 --reference "$folder/tensor.exr" -q -o "$folder/stored"
holds "$folder/stored/study.json" 'all(0 < q["relmse"]["value"] <= x for q, x in zip(p, (1e-3, 1e-4, 1e-6)))'
holds "$folder/stored/study.json" '0 < p[0]["bytes"] < p[1]["bytes"] < p[2]["bytes"]'
holds "$folder/stored/study.json" 'all(abs(q["variance"]["value"]) < 1e-12 for q in p)'
expect 1 "$relume" study "$scene" --size 5x4 --vary integrator=stored --vary "filename=$tensor" \
    --vary budget=1e-3 --vary spp=1 --repeat 2 --reference-spp 4 -o "$folder/stored"
contains "$err" "picture of 5x4"
expect 1 "$relume" study "$scene" --size "$size" --vary integrator=stored --vary budget=1e-3 --vary spp=1 \
    --repeat 2 --reference "$folder/tensor.exr" -o "$folder/stored"
contains "$err" "filename"

# Ctrl-C writes what there is.
"$relume" study "$scene" --size 24x24 --vary spp=1,1000000 --reference-spp 64 -q \
    -o "$folder/stopped" 2>"$folder/err" &
pid=$!
for _ in $(seq 100); do
    [ -e "$folder/stopped/reference.exr" ] && break
    sleep 0.1
done
sleep 2
kill -INT $pid
code=0
wait $pid || code=$?
[ $code -eq 3 ] || fail "exit code $code after SIGINT: $(cat "$folder/err")"
holds "$folder/stopped/study.json" 's["stopped"] and len(p) == 1'
finish
