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
finish
