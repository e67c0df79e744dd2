#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# relume compare: numbers, limits, maps, refusals.
#
# usage: compare.sh RELUME
set -u
relume=$1
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"

one=$folder/one.pfm two=$folder/two.pfm large=$folder/large.pfm
make_pfm "$one" 20 18 3f800000
make_pfm "$two" 20 18 40000000
make_pfm "$large" 40 36 40000000

expect 0 "$relume" compare "$one" "$one" --json
near "$out" mean.value 1
near "$out" mse.value 0
near "$out" ssim.value 1
near "$out" flip.value 0

expect 0 "$relume" compare "$one" "$two" --json
near "$out" mean.value 2
near "$out" mse.value 1
near "$out" relmse.value 0.999000999
near "$out" width 20
expect 0 "$relume" compare "$one" "$two" --json --eps 0
near "$out" relmse.value 1
expect 0 "$relume" compare "$one" "$two"
contains "$out" "mean ratio   2"

expect 0 "$relume" compare "$one" "$two" --fail-above mse=1.01 --fail-above mean=1.01
expect 1 "$relume" compare "$one" "$two" --fail-above mse=0.99
contains "$err" "mse=0.99"
expect 1 "$relume" compare "$one" "$two" --fail-above mse=5 --fail-above mean=0.5
expect 2 "$relume" compare "$one" "$two" --fail-above mes=1
expect 2 "$relume" compare "$one" "$two" --fail-above mse=x
expect 2 "$relume" compare "$one"
expect 2 "$relume" compare "$one" "$two" --fail-abov3 mse=1
contains "$err" "--fail-above"
expect 2 "$relume" compare "$one" "$two" --map-kind signed
expect 2 "$relume" compare "$one" "$two" --samples 4

expect 1 "$relume" compare "$one" "$large"
contains "$err" "$large"
contains "$err" "40 x 36"
expect 0 "$relume" compare "$one" "$large" --downsample 2 --json
near "$out" mean.value 2
near "$out" width 20
expect 0 "$relume" compare "$two" "$one" --downsample 2 --json
near "$out" width 10
expect 1 "$relume" compare "$one" "$folder/none.pfm"
contains "$err" "none.pfm"

expect 0 "$relume" compare "$one" "$one" --ztest "$one" --samples 4 --json
near "$out" ztest.pixels.share 1
expect 1 "$relume" compare "$one" "$two" --ztest "$one" --samples 100 --json
near "$out" ztest.pixels.share 0
near "$out" ztest.relative_difference 1
expect 1 "$relume" compare "$one" "$one" --ztest "$one"
contains "$err" "--samples"

for kind in flip signed; do
    expect 0 "$relume" compare "$one" "$two" --map "$folder/map.png" --map-kind $kind
    expect 0 "$relume" info "$folder/map.png" --json
    near "$out" width 20
    near "$out" height 18
done
near "$out" channels.0.mean 0.996078431 # signed, 1 / 1.01: twice the reference is red
near "$out" channels.2.mean 0
expect 1 "$relume" compare "$one" "$two" --map "$folder/no/map.png"
expect 2 "$relume" compare "$one" "$two" --map "$folder/map.exr"
contains "$err" "ends in .png"

# One pixel that is not finite is left out of the metrics, and no limit holds.
odd=$folder/odd.pfm
head -c -12 "$one" >"$odd"
printf '\0\0\xc0\x7f\0\0\xc0\x7f\0\0\xc0\x7f' >>"$odd"
expect 0 "$relume" compare "$one" "$odd" --json
near "$out" left_out 3
near "$out" mse.value 0
for limit in mse=1000 relmse=1000 mean=1000; do
    expect 1 "$relume" compare "$one" "$odd" --fail-above $limit
    contains "$err" "are not finite"
    expect 1 "$relume" compare "$odd" "$one" --fail-above $limit
done

# Our own pictures: a floor under a lamp, by independent samples.
cat >"$folder/scene.xml" <<'END'
<scene version="3.0.0">
    <default name="light" value="2"/>
    <integrator type="path"><integer name="max_depth" value="2"/></integrator>
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="0,3,3" target="0,0,0" up="0,1,0"/></transform>
        <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="12"/>
            <rfilter type="box"/></film>
        <sampler type="independent"/>
    </sensor>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="-90"/><scale value="5"/></transform></shape>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="90"/><translate y="4"/></transform>
        <emitter type="area"><spectrum name="radiance" value="$light"/></emitter></shape>
</scene>
END
render() {
    expect 0 "$relume" render "$folder/scene.xml" -o "$folder/$1.exr" -q --spp "${@:2}"
}
render ref 256 --variance
render same 32 --variance --seed 5
render brighter 32 --variance --seed 5 -D light=2.2
render plain 256
[ -z "$err" ] || fail "a warning: $err"
render single 1 --variance
contains "$err" "variance of one sample"
ref=$folder/ref.exr same=$folder/same.exr

# Samples are those the files say, and the variance that of the layer.
expect 0 "$relume" compare "$ref" "$same" --ztest "$ref" --json
near "$out" ztest.samples 32
near "$out" ztest.ref_samples 256
expect 1 "$relume" compare "$ref" "$folder/brighter.exr" --ztest "$ref"
expect 0 "$relume" compare "$ref" "$same" --ztest "$ref" --samples 30 --ref-samples 200 --json
near "$out" ztest.samples 30
near "$out" ztest.ref_samples 200
expect 0 "$relume" compare "$one" "$one" --ztest "$one" --samples 4 --json
near "$out" ztest.ref_samples 32000
expect 1 "$relume" compare "$ref" "$same" --ztest "$folder/plain.exr"
contains "$err" "plain.exr: is a picture without a layer variance"
expect 1 "$relume" compare "$ref" "$same" --ztest "$folder/single.exr"
contains "$err" "single.exr: the z-test needs a variance of more than one sample"

# rename FILE FROM TO: an attribute of ref, and another one so that the header keeps its length.
rename() {
    python3 - "$ref" "$folder/$1" "$2" "$3" <<'END'
import sys
data = open(sys.argv[1], "rb").read()
old, new = (name.encode() + b"\0" for name in sys.argv[3:])
seed = b"relume.seed"
assert data.count(old) == 1 and data.count(seed + b"\0") == 1
data = data.replace(seed + b"\0", seed + b"x" * (len(old) - len(new)) + b"\0").replace(old, new)
open(sys.argv[2], "wb").write(data)
END
}
rename other.exr relume.samples samples
expect 0 "$relume" compare "$folder/other.exr" "$same" --ztest "$folder/other.exr" --json
near "$out" ztest.ref_samples 256
rename silent.exr relume.samples silence
expect 1 "$relume" compare "$ref" "$same" --ztest "$folder/silent.exr"
contains "$err" "silent.exr: does not say its samples per pixel"
expect 0 "$relume" compare "$ref" "$same" --ztest "$folder/silent.exr" --ref-samples 256

# Intervals: where the pictures differ by more than noise; not of one picture with itself, nor of
# one sample.
expect 0 "$relume" compare "$ref" "$folder/brighter.exr"
[[ $out == *"MSE "*" +- "*" (95 %)"* && $out != *"not known"* ]] || fail "no intervals: $out"
expect 0 "$relume" compare "$ref" "$ref"
contains "$out" "MSE          0 +- not known"
expect 0 "$relume" compare "$ref" "$ref" --json
contains "$out" '"mse": {
    "value": 0.0,
    "error": null'
expect 0 "$relume" compare "$ref" "$folder/single.exr"
contains "$err" "single.exr: its layer variance is of one sample per pixel"
[[ $out != *"+-"* ]] || fail "an interval of one sample: $out"
finish
