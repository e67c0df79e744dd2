#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# relume tensor requantise --budget: the error stays within the budget and is told, edits of all kinds
# work on what is stored, wrong usage is refused.
#
# usage: budget.sh RELUME
set -u
# LeakSanitizer itself dies now and then where PoCL has threads.
export ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0
relume=$(realpath "$1")
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"

scene=$(realpath "$(dirname "${BASH_SOURCE[0]}")/../../data/scenes/cornell-glossy/scene.xml")
tensors=$(dirname "$relume")/../tests # files that the build makes
cd "$folder" || exit 1
cp "$tensors/polynomial.safetensors" t.safetensors

# size FILE
size() { stat -c %s "$1"; }

expect 0 "$relume" edit t.safetensors -o whole.exr
expect 0 "$relume" edit t.safetensors -o whole-sharp.exr --set cup.exponent=20 --set pot.lid.exponent_v=4
for budget in 1e-3 1e-5; do
    expect 0 "$relume" tensor requantise t.safetensors -o "$budget.safetensors" --budget relmse=$budget --json
    contains "$out" '"int8"'
    expect 0 "$relume" tensor check "$budget.safetensors"
    expect 0 "$relume" tensor info "$budget.safetensors"
    contains "$out" "storage relmse"
    expect 0 "$relume" edit "$budget.safetensors" -o small.exr
    expect 0 "$relume" compare whole.exr small.exr --fail-above relmse=$budget
    expect 1 "$relume" compare whole.exr small.exr --fail-above relmse=1e-9
    expect 0 "$relume" edit "$budget.safetensors" -o sharp.exr --set cup.exponent=20 --set pot.lid.exponent_v=4
    expect 0 "$relume" compare whole-sharp.exr sharp.exr --fail-above relmse=$budget
done
[ "$(size 1e-3.safetensors)" -lt "$(($(size t.safetensors) / 3))" ] || fail "1e-3 is large"
[ "$(size 1e-3.safetensors)" -lt "$(size 1e-5.safetensors)" ] || fail "a larger budget is no smaller"

# Frozen, by few terms, by the twins: the pictures of a full product.
cat >session.json <<'END'
{"steps": [{"set": "cup.exponent=200", "frames": 3},
           {"op": "cup.specular.f_A:translate-y,10,20,30,40,0.1", "settle": true},
           {"set": "pot.lid.exponent_v=4"}, {"reset": "cup"}]}
END
expect 0 "$relume" edit 1e-3.safetensors -o full.exr --set pot.lid.exponent_v=4
for more in "" "--terms 3" "--no-device"; do
    # shellcheck disable=SC2086 # words
    expect 0 "$relume" edit 1e-3.safetensors --script session.json -o last.exr $more
    expect 0 "$relume" compare full.exr last.exr --fail-above relmse=1e-9
done

# Unpacked, cropped and stored again.
expect 0 "$relume" tensor requantise 1e-3.safetensors -o float.safetensors
expect 0 "$relume" edit float.safetensors -o float.exr
expect 0 "$relume" edit 1e-3.safetensors -o small.exr
expect 0 "$relume" compare float.exr small.exr --fail-above relmse=1e-10
expect 0 "$relume" tensor crop 1e-3.safetensors -o part.safetensors --crop 2,2,9,8
expect 0 "$relume" tensor requantise 1e-3.safetensors -o again.safetensors --budget relmse=1e-2 --no-halves
[ "$(size again.safetensors)" -lt "$(size 1e-3.safetensors)" ] || fail "1e-2 is larger than 1e-3"

# As well at any brightness; not where a value is not finite.
for factor in 1e-30 1e30 nan; do
    python3 - t.safetensors scaled.safetensors $factor <<'END'
import array, json, struct, sys
data = bytearray(open(sys.argv[1], "rb").read())
n, = struct.unpack("<Q", data[:8])
for name, entry in json.loads(data[8:8 + n]).items():
    if name.endswith("values") or name.endswith("halves") or name == "fixed":
        a, b = (8 + n + at for at in entry["data_offsets"])
        values = array.array("f", data[a:b])
        data[a:b] = array.array("f", [v * float(sys.argv[3]) for v in values]).tobytes()
open(sys.argv[2], "wb").write(data)
END
    [ $factor = nan ] && break
    expect 0 "$relume" tensor requantise scaled.safetensors -o small.safetensors --budget relmse=1e-4
    expect 0 "$relume" edit scaled.safetensors -o scaled.exr
    expect 0 "$relume" edit small.safetensors -o small-scaled.exr
    expect 0 "$relume" compare scaled.exr small-scaled.exr --fail-above relmse=1e-4
    [ "$(size small.safetensors)" -lt "$(($(size scaled.safetensors) / 3))" ] || fail "$factor: not smaller"
done
expect 1 "$relume" tensor requantise scaled.safetensors -o u.safetensors --budget relmse=1e-4
contains "$err" "not finite"

# In its own place.
expect 0 "$relume" tensor requantise t.safetensors -o t.safetensors --budget relmse=1e-3
expect 0 "$relume" edit t.safetensors -o own.exr
expect 0 "$relume" compare own.exr small.exr --fail-above relmse=1e-12

expect 2 "$relume" tensor requantise t.safetensors -o u.safetensors --budget 1e-3
expect 2 "$relume" tensor requantise t.safetensors -o u.safetensors --budget relmse=-1
expect 2 "$relume" tensor requantise t.safetensors -o u.safetensors --budget relmse=1e-3 --half
expect 2 "$relume" tensor requantise t.safetensors -o u.safetensors --no-halves
expect 1 "$relume" tensor requantise "$tensors/relight.safetensors" -o u.safetensors --budget relmse=1e-3
contains "$err" "precompute edit"
expect 2 "$relume" precompute relight none.xml -o u.safetensors --budget relmse=1e-3
expect 2 "$relume" precompute edit none.xml -o u.safetensors --budget relmse=1e-3 --half

# A limit of noise goes with a budget, and leaves no sums; what is to be gone on with does not.
expect 0 "$relume" precompute edit "$scene" -o noise.safetensors --size 8x8 --bounces 2 --series 8,1 --spp 64 \
    --noise 10 --budget relmse=1e-3 -q
expect 0 "$relume" tensor info noise.safetensors
contains "$out" "storage relmse"
expect 1 "$relume" precompute edit "$scene" -o noise.safetensors --size 8x8 --bounces 2 --series 8,1 --spp 128 --resume -q
contains "$err" "sums"
for option in --resume "--checkpoint 5" "--samples 0:64"; do
    # shellcheck disable=SC2086
    expect 2 "$relume" precompute edit none.xml -o u.safetensors --budget relmse=1e-3 $option
done
finish
