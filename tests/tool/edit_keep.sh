#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Editing tensors with bounces by and by: killed and resumed, in ranges that are merged, extended, and
# stopped by a clock; arrays are compared bit for bit.
#
# usage: edit_keep.sh RELUME         RELUME_TEST_FULL: kill 40 times instead of 3
set -u
# LeakSanitizer itself dies now and then where PoCL has threads.
export ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0
relume=$1
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"
kills=3
[ -z "${RELUME_TEST_FULL:-}" ] || kills=40

# room NEEDLE: a scene; its needle is thin: not all ranges of samples meet it in the same pixels.
room() {
    cat <<END
<scene version="3.0.0"><integrator type="path"/>
<sensor type="perspective"><float name="fov" value="60"/><transform name="to_world">
<lookat origin="0,1,4" target="0,0.5,0" up="0,1,0"/></transform><sampler type="sobol"/>
<film type="hdrfilm"><integer name="width" value="25"/><integer name="height" value="15"/>
<rfilter type="tent"/></film></sensor>
<emitter type="constant"><rgb name="radiance" value="0.1,0.2,0.3"/></emitter>
<shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate x="1" angle="-90"/>
</transform><bsdf type="editable" id="floor"><string name="model" value="phong"/>
<rgb name="diffuse_reflectance" value="0.4"/><rgb name="specular_reflectance" value="0.3"/></bsdf>
</shape><shape type="sphere"><point name="center" x="0" y="0.6" z="0"/>
<float name="radius" value="0.6"/><bsdf type="editable" id="ball"><string name="model"
value="freehand"/><string name="gamma_o" value="theta_o"/>
<rgb name="specular_reflectance" value="0.2"/></bsdf></shape>
<shape type="cylinder"><float name="radius" value="$1"/><point name="p0" x="-1" y="0" z="0.5"/>
<point name="p1" x="1" y="2" z="0.5"/><bsdf type="editable" id="needle"><string name="model"
value="lightview"/><rgb name="specular_reflectance" value="0.5"/></bsdf></shape>
<shape type="rectangle"><transform name="to_world"><scale value="0.4"/><rotate x="1" angle="90"/>
<translate y="2.5"/></transform><emitter type="area"/></shape></scene>
END
}
room 0.001 >"$folder/room.xml"
scene=$folder/room.xml
options=(--bounces 3 --series "16,1,1" --quiet)

# tensor NAME OPTION...: NAME.safetensors in the folder
tensor() {
    local name=$1
    shift
    expect 0 "$relume" precompute edit "$scene" -o "$folder/$name.safetensors" "${options[@]}" "$@"
}

# same A B: the same arrays, sums apart
same() {
    python3 - "$folder/$1.safetensors" "$folder/$2.safetensors" <<'END' || fail "$1 and $2 differ"
import json, struct, sys
def arrays(path):
    data = open(path, "rb").read()
    size, = struct.unpack("<Q", data[:8])
    header = json.loads(data[8:8 + size])
    meta = json.loads(header["__metadata__"]["relume"])
    names = [b["object"] + "." + b["term"] for b in meta["blocks"] if b["pixels"]]
    found = {}
    for key, entry in header.items():
        block, _, name = key.rpartition(".")
        if key == "__metadata__" or block == "padding" or "sums" in name or name == "views":
            continue
        if block:
            b = meta["blocks"][int(block)]
            if not b["pixels"]:
                continue
            key = b["object"] + "." + b["term"] + "." + name
        a, z = entry["data_offsets"]
        found[key] = (entry["shape"], data[8 + size + a:8 + size + z])
    return meta["samples"], names, found
a, b = arrays(sys.argv[1]), arrays(sys.argv[2])
bad = [k for k in a[2].keys() | b[2].keys() if a[2].get(k) != b[2].get(k)]
if a[:2] != b[:2] or bad:
    print("samples and blocks", a[:2], b[:2], "arrays that differ:", sorted(bad)[:9])
    sys.exit(1)
END
}

# merged OUT PART...
merged() {
    local name=$1 parts=() part
    shift
    for part; do parts+=("$folder/$part.safetensors"); done
    expect 0 "$relume" tensor merge "${parts[@]}" -o "$folder/$name.safetensors" --quiet
}

spp=256
tensor whole --spp $spp
tensor other --spp $spp --seed 1
[[ $(same whole other) == *FAILED* ]] || fail "the comparison cannot fail"

# Quarters, in any order; merges of merges; none twice.
tensor a --spp $spp --samples 0:64
tensor b --spp $spp --samples 64:128
tensor c --spp $spp --samples 128:192
tensor d --spp $spp --samples 192:256
merged all d b a c
same whole all
merged cd d c
merged all b cd a
same whole all
expect 1 "$relume" tensor merge "$folder/cd.safetensors" "$folder/d.safetensors" -o "$folder/x"
contains "$err" "among the others"
expect 1 "$relume" precompute edit "$scene" -o "$folder/x" "${options[@]}" --samples 100:250
contains "$err" "128:256"

# What is too little memory is told in full, however little.
expect 1 "$relume" precompute edit "$scene" -o "$folder/x" "${options[@]}" --memory 0.00012
contains "$err" "more than the 0.00012 GB of --memory"

# Killed at random moments until it is done.
run=("$relume" precompute edit "$scene" -o "$folder/killed.safetensors" "${options[@]}" --spp "$spp"
    --checkpoint 0.01 --resume)
RANDOM=4711
for ((i = 0; i < kills; i++)); do
    timeout -s KILL "0.$(printf %03d $((RANDOM % 300 + 30)))" "${run[@]}" 2>/dev/null
    [ ! -e "$folder/killed.safetensors" ] ||
        expect 0 "$relume" tensor check "$folder/killed.safetensors" --quiet
done
expect 0 "${run[@]}"
same whole killed

# A finished tensor is extended, by the same options only; what was refused is still there.
tensor extended --spp 100 --resume
tensor extended --spp $spp --resume
same whole extended
expect 1 "$relume" precompute edit "$scene" -o "$folder/extended.safetensors" --bounces 2 --spp 999 \
    --resume
contains "$err" "other options"
for other in "--max-depth 5" "--crop 0,0,9,9" "--seed 3" "--sampler independent" "--group g=floor,ball"; do
    # shellcheck disable=SC2086
    expect 1 "$relume" precompute edit "$scene" -o "$folder/extended.safetensors" "${options[@]}" \
        --spp 999 --resume $other
    contains "$err" "other options"
done
expect 1 "$relume" precompute edit "$scene" -o "$folder/whole.safetensors" "${options[@]}" --spp 999 \
    --resume
contains "$err" "not kept its sums"
same whole extended

# Noise that is asked for, reached or not.
noise=$("$relume" edit "$folder/whole.safetensors" -o "$folder/x.exr" --quiet --json --no-device |
    python3 -c 'import json, sys; print(json.load(sys.stdin)["noise"])')
tensor noise --noise "$noise" --json
python3 -c 'import json, sys
r, noise = json.loads(sys.argv[1]), float(sys.argv[2])
sys.exit(not (r["noise"] <= noise and r["samples"] % 64 == 0 and 64 < r["samples"] < 2048))' "$out" "$noise" ||
    fail "--noise $noise: $out"
expect 3 "$relume" precompute edit "$scene" -o "$folder/noise.safetensors" "${options[@]}" --spp 128 \
    --noise 1e-4

# A clock; the tensor that is there can be edited.
expect 0 "$relume" precompute edit "$scene" -o "$folder/time.safetensors" "${options[@]}" --spp 1000000 \
    --time 0.5 --json
python3 -c 'import json, sys
r = json.loads(sys.argv[1])
sys.exit(not (0.3 < r["seconds"] < 10 and 64 <= r["samples"] < 1000000))' "$out" || fail "--time: $out"
expect 0 "$relume" tensor requantise "$folder/time.safetensors" -o "$folder/small.safetensors" --quiet
[ $(($(stat -c %s "$folder/small.safetensors") * 2)) -lt "$(stat -c %s "$folder/time.safetensors")" ] ||
    fail "requantise keeps the sums"

# The error that is told of an edited picture falls as more samples come, by at least their square
# root; where everything is met by many of them.
room 0.2 >"$scene"
tensor part --spp 1024 --samples 0:64
tensor rest --spp 1024 --samples 64:1024
merged full rest part
noise=
for part in part full; do
    expect 0 "$relume" edit "$folder/$part.safetensors" -o "$folder/$part.exr" --set floor.exponent=40 \
        --quiet --json
    noise+=" $(python3 -c 'import json, sys; print(json.loads(sys.argv[1])["noise"])' "$out")"
done
python3 -c 'import sys
a, b = map(float, sys.argv[1].split())
print("noise of 64 samples / of 1024:", a / b)
sys.exit(not 3 < a / b < 40)' "$noise" || fail "errors of a part and the whole: $noise"
finish
