#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# relume edit and relume tensor: pictures of a small tensor, sessions, the toolbox, wrong usage.
#
# usage: edit.sh RELUME
set -u
# LeakSanitizer itself dies now and then where PoCL has threads.
export ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0
relume=$(realpath "$1")
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"

tensors=$(dirname "$relume")/../tests # files that the build makes
cd "$folder" || exit 1
cp "$tensors/linear.safetensors" t.safetensors

# same A B, differs A B: the same pixels or not
same() { expect 0 "$relume" compare "$1" "$2" --fail-above relmse=1e-12; }
differs() { expect 1 "$relume" compare "$1" "$2" --fail-above relmse=1e-12; }

expect 0 "$relume" edit t.safetensors --list
contains "$out" "cup: blinnphong"
contains "$out" 'cup.specular.f_A  "lobe" of theta_h, 32 nodes'
contains "$out" "pot.lid.specular  scale="
expect 0 "$relume" edit t.safetensors --list --json
near "$out" objects.1.terms.0.f_A.coefficients 32
near "$out" objects.1.parameters.exponent_u 20
near "$out" objects.0.terms.0.pixels 100

expect 0 "$relume" edit t.safetensors -o plain.exr
contains "$err" "first frame"
expect 0 "$relume" edit t.safetensors -o twin.exr --no-device
same plain.exr twin.exr
expect 0 "$relume" edit t.safetensors -o same.exr --set cup.exponent=20 --variance
expect 0 "$relume" compare plain.exr same.exr
expect 0 "$relume" info same.exr
contains "$out" "variance.Y"
expect 0 "$relume" edit t.safetensors -o sharp.exr --set cup.specular.exponent=200 --set pot.lid.exponent_v=4
# Lobes too sharp for 32 nodes, which carry cos^37.9, are warned of, and no others; once.
[ "$(grep -c "as sharp as cos^200 comes out too wide: the 32 bins .* carry cos^37.9" <<<"$err")" = 1 ] ||
    fail "a sharp lobe is not told, or twice: $err"
expect 0 "$relume" edit t.safetensors -o even.exr --set cup.exponent=37 --quiet
[ -z "$err" ] || fail "a lobe that fits is warned of: $err"
expect 0 "$relume" edit t.safetensors -o even.exr --set cup.exponent=38 --set cup.exponent=39 --quiet
[ "$(grep -c "too wide" <<<"$err")" = 1 ] || fail "not one warning: $err"
differs plain.exr sharp.exr
expect 0 "$relume" edit t.safetensors -o file.exr --op "cup.specular.f_A:amplify-y,0,0,90,90,2"
expect 0 "$relume" edit t.safetensors -o double.exr --set cup.specular.scale=1.750704 # (20 + 2) / (4 pi)
expect 0 "$relume" compare file.exr double.exr --fail-above relmse=1e-9
printf 'at,value\n0,2\n90,0\n' >line.csv
expect 0 "$relume" edit t.safetensors -o line.exr --curve cup.specular.f_A=line.csv
differs plain.exr line.exr

# A session ends where its changes lead, whatever way it takes.
cat >session.json <<'END'
{"steps": [{"set": "cup.exponent=200", "frames": 3, "write": true},
           {"op": "cup.specular.f_A:translate-y,10,20,30,40,0.1", "settle": true},
           {"reset": "cup"}, {"set": ["cup.exponent=200", "pot.lid.exponent_v=4"], "write": true}]}
END
for more in "" "--terms 3" "--no-device"; do
    # shellcheck disable=SC2086 # words
    expect 0 "$relume" edit t.safetensors --script session.json -o last.exr $more
    contains "$err" "step 1 frame 3"
    expect 0 "$relume" compare sharp.exr last.exr --fail-above relmse=1e-9
    expect 0 "$relume" compare sharp.exr last.0004.exr --fail-above relmse=1e-9
    differs last.0001.exr last.exr
done
expect 0 "$relume" edit t.safetensors --script session.json -o last.exr --json --time --quiet
[ "$(wc -l <<<"$out")" -eq 7 ] || fail "expected a line for each of 6 frames and one for the picture: $out"
near "$(sed -n 2p <<<"$out")" frame 2
last=$(tail -n 1 <<<"$out")
near "$last" pixels 247
near "$last" coefficients 128
for key in product_seconds frame_seconds gigabytes_per_second machine_gigabytes_per_second bytes; do
    contains "$last" "\"$key\""
done

expect 2 "$relume" edit t.safetensors
for wrong in "--list -o out.exr" "--script session.json --time" "-o out.exr --terms 3" "-o out.exr --scene a.xml"; do
    # shellcheck disable=SC2086 # words
    expect 2 "$relume" edit t.safetensors $wrong
done
expect 0 "$relume" edit t.safetensors --list --set cup.exponent=77 --json
near "$out" objects.1.parameters.exponent_u 77
expect 1 "$relume" edit t.safetensors --list --set can.exponent=77
expect 2 "$relume" tensor info t.safetensors -o none.safetensors
expect 2 "$relume" tensor check t.safetensors --half
expect 1 "$relume" edit none.safetensors -o out.exr
expect 1 "$relume" edit "$tensors/relight.safetensors" -o out.exr
contains "$err" "not a tensor of \`relume precompute edit\`"
expect 1 "$relume" edit t.safetensors -o out.exr --set can.exponent=3
contains "$err" "there are: pot.lid cup"
expect 1 "$relume" edit t.safetensors -o out.exr --set cup.eta=1.5
contains "$err" "is fixed"
for wrong in "translate-y,0,0,90,90,0.1,5" "amplify-y,0,0,90" "" "amplify-z,0,0,90,90,2"; do
    expect 1 "$relume" edit t.safetensors -o out.exr --op "cup.specular.f_A:$wrong"
done
echo '{"steps": [{"turn": 1}]}' >bad.json
expect 1 "$relume" edit t.safetensors --script bad.json
contains "$err" "bad.json: step 1"
echo '{"steps": [{"write": true}]}' >bad.json
expect 1 "$relume" edit t.safetensors --script bad.json
[ ! -e out.exr ] || fail "a picture was written after an error"

# ---- the toolbox ----------------------------------------------------------------------------

expect 0 "$relume" tensor info t.safetensors
contains "$out" "object cup"
expect 0 "$relume" tensor info t.safetensors --json
near "$out" blocks.0.coefficients 64
near "$out" samples 16
expect 0 "$relume" tensor check t.safetensors
contains "$err" "sound"
expect 0 "$relume" tensor requantise t.safetensors -o half.safetensors --half
expect 0 "$relume" edit half.safetensors -o half.exr
expect 0 "$relume" compare plain.exr half.exr --fail-above relmse=1e-4
differs plain.exr half.exr
[ "$(stat -c %s half.safetensors)" -lt $(($(stat -c %s t.safetensors) * 3 / 5)) ] || fail "16 bits are not half"
cp "$tensors/more.safetensors" .
expect 0 "$relume" tensor merge t.safetensors more.safetensors -o all.safetensors --json
near "$out" samples 48
expect 0 "$relume" edit all.safetensors -o all.exr
expect 1 "$relume" tensor merge t.safetensors t.safetensors -o none.safetensors
contains "$err" "seed"
expect 0 "$relume" tensor crop t.safetensors -o part.safetensors --crop 2,3,12,13
expect 0 "$relume" edit part.safetensors -o part.exr
expect 0 "$relume" info part.exr --json
near "$out" width 10
expect 1 "$relume" tensor crop t.safetensors -o none.safetensors --crop 2,3,50,13
expect 2 "$relume" tensor crop t.safetensors -o none.safetensors
expect 2 "$relume" tensor merge t.safetensors -o none.safetensors
expect 2 "$relume" tensor shrink t.safetensors
expect 1 "$relume" tensor export t.safetensors -o none.exr
contains "$err" "precompute relight"
[ ! -e none.safetensors ] || fail "a tensor was written after an error"
# A value that is not finite: told by check, refused by edit.
python3 - t.safetensors bad.safetensors <<'END'
import json, struct, sys
data = bytearray(open(sys.argv[1], "rb").read())
n, = struct.unpack("<Q", data[:8])
begin = json.loads(data[8:8 + n])["0.values"]["data_offsets"][0]
data[8 + n + begin:12 + n + begin] = struct.pack("<f", float("nan"))
open(sys.argv[2], "wb").write(data)
END
expect 1 "$relume" tensor check bad.safetensors
contains "$err" "not finite"
expect 1 "$relume" edit bad.safetensors -o out.exr
contains "$err" "not finite"
# A shape that the camera does not see casts shadows only, in a tensor with bounces as in the picture: a
# tensor that lists it in its pixels has no place there for the light of the floor.
cat >hidden.xml <<'END'
<scene version="3.0.0"><default name="depth" value="4"/>
<integrator type="path"><integer name="max_depth" value="$depth"/></integrator>
<sensor type="perspective"><transform name="to_world"><lookat origin="0,1,5" target="0,0.5,0" up="0,1,0"/>
</transform><film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="18"/>
<rfilter type="box"/></film></sensor><emitter type="constant"/><bsdf type="diffuse" id="floor"/>
<shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate x="1" angle="-90"/></transform>
<ref id="floor"/></shape><shape type="sphere"><point name="center" x="0" y="0.7" z="1"/>
<float name="radius" value="0.6"/><boolean name="visible_to_camera" value="false"/></shape></scene>
END
expect 0 "$relume" precompute edit hidden.xml -o hidden.safetensors --edit floor --bounces 3 \
    --series "8,1,1" --spp 64 --quiet
expect 0 "$relume" edit hidden.safetensors -o hidden.exr
# The nearest numbers of a model are told of curves that were edited by hand.
sed 's|<bsdf type="diffuse" id="floor"/>|<bsdf type="phong" id="floor"><float name="exponent" value="16"/></bsdf>|' \
    hidden.xml >phong.xml
expect 0 "$relume" precompute edit phong.xml -o phong.safetensors --edit floor --direct --lights 16 --spp 1 --quiet
expect 0 "$relume" edit phong.safetensors --set floor.exponent=40 --save-scene saved.xml
contains "$(cat saved.xml)" "exponent_u 40,"
contains "$(cat saved.xml)" "misses 0 %"
expect 0 "$relume" edit phong.safetensors --op "floor.specular.f_A:amplify-x,0,0,10,90,2" --save-scene saved.xml
python3 - saved.xml <<'END' || fail "the nearest exponent is not told: $(cat saved.xml)"
import re, sys
exponent, missing = re.search(r"exponent_u ([\d.]+),.* misses ([\d.]+) %", open(sys.argv[1]).read()).groups()
assert 3 < float(exponent) < 5 and 0.1 < float(missing) < 20 # 16 / 4 where the factor is whole, (exponent, missing)
END
expect 1 "$relume" verify hidden.safetensors hidden.xml -D depth=5 --pixels 16
contains "$err" "found -D depth=5, expected none"
expect 0 "$relume" verify hidden.safetensors hidden.xml --pixels 64 --spp 16
contains "$err" "432 pixels in 30 blocks"
expect 0 "$relume" verify hidden.safetensors hidden.xml --pixels 480 --spp 16 --quiet
[ -z "$err" ] || fail "the whole picture is warned of: $err"
expect 0 "$relume" render hidden.xml -o seen.exr --spp 64 --quiet
expect 0 "$relume" compare seen.exr hidden.exr --fail-above relmse=2e-3

finish
