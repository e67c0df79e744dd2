#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# relume brdf: albedos of known materials, conversions there and back, drawings, and wrong usage.
#
# usage: brdf.sh RELUME
set -u
relume=$1
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"

# roughly JSON INDEX VALUE: the first channel of directional albedo INDEX, to 1 %
roughly() {
    python3 - "$@" <<'END' || fail "albedo $2 is not $3"
import json, sys
value = json.loads(sys.argv[1])["directional_albedo"][int(sys.argv[2])]["albedo"][0]
print(value)
sys.exit(0 if abs(value / float(sys.argv[3]) - 1) < 0.01 else 1)
END
}

expect 0 "$relume" brdf diffuse -D reflectance=0.8 --json
near "$out" directional_albedo.3.albedo.1 0.8
near "$out" hemispherical_albedo.2 0.8
near "$out" reciprocity_error.mean 0
near "$out" energy_error 0
expect 0 "$relume" brdf diffuse
contains "$out" "lobes: diffuse reflection"

# A constant table is diffuse, as MERL table and as transfer probabilities.
for file in paint.binary paint.transfer; do
    expect 0 "$relume" brdf diffuse -D reflectance=0.25 --to "$folder/$file"
    expect 0 "$relume" brdf "$folder/$file" --json
    roughly "$out" 0 0.25
    roughly "$out" 4 0.25
done

# Glass that absorbs nothing returns all energy, though less radiance.
expect 0 "$relume" brdf dielectric --json
near "$out" directional_albedo.0.albedo.0 1
near "$out" directional_albedo.7.albedo.2 1
expect 0 "$relume" brdf roughdielectric -D alpha=0.01 --json
roughly "$out" 2 1

# A table that was written here has no holes to warn of; what it cannot hold is said.
expect 0 "$relume" brdf phong -D exponent=5 --to "$folder/phong.binary"
[ -z "$err" ] || fail "a reciprocal material: $err"
expect 0 "$relume" brdf "$folder/phong.binary"
[ -z "$err" ] || fail "its table: $err"
cat >"$folder/tilted.xml" <<'END'
<scene version="3.0.0">
    <bsdf type="normalmap" id="tilted">
        <texture type="bitmap" name="normalmap">
            <string name="filename" value="tilt.pfm"/>
            <boolean name="raw" value="true"/>
        </texture>
        <bsdf type="diffuse"/>
    </bsdf>
    <shape type="sphere"><ref id="tilted"/></shape>
    <sensor type="perspective"/>
</scene>
END
make_pfm "$folder/tilt.pfm" 1 1 3f400000
expect 0 "$relume" brdf "$folder/tilted.xml" --id tilted --to "$folder/tilted.binary"
contains "$err" "not reciprocal"

for kind in cut lobe curve; do
    expect 0 "$relume" brdf roughplastic --plot "$folder/$kind.svg" --kind $kind --angles 0,45
    contains "$(cat "$folder/$kind.svg")" "<polyline"
done
expect 0 "$relume" brdf roughplastic --plot "$folder/cut.png"
expect 0 "$relume" info "$folder/cut.png" --json
near "$out" width 640

# As curves, all in one and one by one; 64 bins are the material to 1 %.
expect 0 "$relume" brdf roughconductor -D material=Au -D alpha=0.2 -D distribution=beckmann \
    --to "$folder/gold.json"
expect 0 "$relume" brdf roughconductor -D material=Au -D alpha=0.2 -D distribution=beckmann --json
gold=$(python3 -c 'import json, sys
print(json.loads(sys.argv[1])["directional_albedo"][0]["albedo"][0])' "$out")
expect 0 "$relume" brdf editable -D model=cooktorrance -D edited="$folder/gold.json" --json
roughly "$out" 0 "$gold"
expect 0 "$relume" brdf phong -D exponent=40 --to "$folder/lobe.csv"
head -3 "$folder/lobe-specular-f_A.csv" | grep -q '^from,to\|^at' || fail "no curve in lobe-specular-f_A.csv"
expect 1 "$relume" brdf dielectric --to "$folder/glass.csv"
contains "$err" "lets light through"

# What no generator is near to becomes factors: those of a table, and from a table of these the same.
expect 0 "$relume" brdf roughconductor -D material=Au -D alpha=0.3 --to "$folder/gold.binary"
expect 0 "$relume" brdf "$folder/gold.binary" --to "$folder/factors.json"
contains "$err" "factors of theta_h and theta_d; they miss 2."
factored=(editable -D model=halfdifference -D edited="$folder/factors.json")
expect 0 "$relume" brdf "${factored[@]}" --to "$folder/factors.binary"
expect 0 "$relume" brdf "$folder/factors.binary" --to "$folder/again.json"
contains "$err" "they miss 0.0 %"

expect 1 "$relume" brdf roughconductor -D alpha=0.2 -D alpha_u=0.1 -D alpha_v=0.1
contains "$err" "alpha was found beside alpha_u and alpha_v"
expect 1 "$relume" brdf conductor -D material=Au -D eta=1
contains "$err" "eta or k was found beside material"
expect 1 "$relume" brdf rougplastic
contains "$err" "did you mean \"roughplastic\""
expect 1 "$relume" brdf roughplastic -D alpa=0.1
contains "$err" "did you mean \"alpha\""
expect 1 "$relume" brdf "$folder/none.binary"
contains "$err" "none.binary"
expect 1 "$relume" brdf diffuse --to "$folder/out.txt"
contains "$err" ".transfer"
expect 2 "$relume" brdf diffuse --plot "$folder/out.pdf"
contains "$err" ".svg"
expect 2 "$relume" brdf diffuse --angles 100
contains "$err" "--angles"
expect 2 "$relume" brdf

finish
