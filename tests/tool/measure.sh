#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# relume measure: a line in, a line out; batches; units; exit codes and messages.
#
# usage: measure.sh RELUME
set -u
relume=$1
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"

cat >"$folder/sky.xml" <<'END'
<scene version='3.0.0'><emitter type='constant'><rgb name='radiance' value='2'/></emitter>
<shape type='rectangle'><transform name='to_world'><rotate x='1' angle='-90'/><scale value='100'/>
</transform><bsdf type='diffuse'><rgb name='reflectance' value='0'/></bsdf></shape></scene>
END
sky=$folder/sky.xml

# An answer to each line before the next is asked for, the same as for all at once.
points=$'0 0 0 0 1 0\n1 1 1 0 2 0\n\n# a comment\n0,1,0 , 0,-1,0\n-3 1 2 1 1 0 # and another'
coproc METER { "$relume" measure "$sky" --quiet; }
one_by_one=
while IFS= read -r line; do
    echo "$line" >&"${METER[1]}"
    [[ $line =~ ^(#.*)?$ ]] || { read -r -t 60 answer <&"${METER[0]}" || fail "no answer to $line"; one_by_one+=$answer$'\n'; }
done <<<"$points"
input=${METER[1]}
exec {input}>&-
at_once=$("$relume" measure "$sky" --quiet --threads 1 <<<"$points")
[ "$one_by_one" = "$at_once"$'\n' ] || fail "one by one: $one_by_one at once: $at_once"
[ "$(wc -l <<<"$at_once")" -eq 4 ] || fail "not four lines: $at_once"

# Units: the same number as radiance, irradiance, lux, cd/m^2.
first() { expect 0 "$relume" measure "$sky" --json "$@" <<<"0 1 0 0 1 0"; }
first --radiance
near "$out" value.2 2
near "$out" samples 1024
first --candela
near "$out" value 1366
first --candela --efficacy 179
near "$out" value 358
contains "$out" '"cd/m^2"'
first --lux --noise 0.002
python3 -c "
import json, math, sys
v = json.loads(sys.argv[1])
sys.exit(not (abs(v['value'] - 683 * 2 * math.pi) < 5 * v['error'] and v['error'] < 0.002 * v['value']))
" "$out" || fail "illuminance or its noise: $out"
expect 0 "$relume" measure "$sky" --lux <<<"0 1 0 0 1 0"
contains "$out" "# lux"

# What is asked for and cannot be had.
expect 3 "$relume" measure "$sky" --noise 1e-9 --spp 2048 <<<"0 1 0 0 1 0"
contains "$out" "6.2"
expect 2 "$relume" measure "$sky" --lux --radiance </dev/null
expect 1 "$relume" measure "$sky" -q <<<$'0 1 0 0 1 0\n0 1 0 0 x 0'
contains "$err" "standard input:2: found 'x'"
contains "$out" "6.2"
expect 1 "$relume" measure "$sky" <<<"0 1 0"
contains "$err" "expected six"
expect 1 "$relume" measure "$sky" <<<"0 1 0 0 0 0"
expect 1 "$relume" measure "$sky" <<<"0 1 0 0 1 nan"
expect 1 "$relume" measure "$sky" <<<"0 1 0 0 1 0 7"
expect 1 "$relume" measure "$sky" --integrator direct <<<"0 1 0 0 1 0"
contains "$err" "path"
if [ -w /dev/full ]; then
    err=$("$relume" measure "$sky" --quiet --spp 64 2>&1 >/dev/full <<<"0 1 0 0 1 0")
    [ $? = 1 ] || fail "a full disk went unsaid"
    contains "$err" "standard output"
fi
expect 0 "$relume" measure "$sky" --quiet </dev/null
[ -z "$out" ] || fail "something for nothing: $out"
finish
