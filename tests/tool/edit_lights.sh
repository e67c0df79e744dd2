#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Lights and materials edited together: a tensor for each light, one session over them.
#
# usage: edit_lights.sh RELUME
set -u
# LeakSanitizer itself dies now and then where PoCL has threads.
export ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0
relume=$(realpath "$1")
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"
cd "$folder" || exit 1

cat >scene.xml <<'END_SCENE'
<scene version="3.0.0">
    <integrator type="path"/>
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="0, 2, 5" target="0, 0.6, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="24"/><integer name="height" value="16"/>
            <rfilter type="box"/></film>
    </sensor>
    <bsdf type="phong" id="paint"><float name="exponent" value="20"/></bsdf>
    <shape type="sphere"><point name="center" y="0.7"/><float name="radius" value="0.7"/><ref id="paint"/></shape>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="-90"/><scale value="3"/></transform>
    </shape>
    <emitter type="point" id="left"><point name="position" x="-3" y="3" z="2"/>
        <rgb name="intensity" value="20, 10, 5"/></emitter>
    <emitter type="point" id="right"><point name="position" x="3" y="3" z="2"/>
        <rgb name="intensity" value="4, 8, 20"/></emitter>
</scene>
END_SCENE

# tensor NAME OPTIONS...: under one light, or under all. Told noise of the sums: 1.8 and 0.6 %, so that
# pictures of the two ways are 4e-4 (relMSE) apart.
tensor() { expect 0 "$relume" precompute edit scene.xml -o "$1.safetensors" --edit paint --quiet "${@:2}"; }
close_to() { expect 0 "$relume" compare "$1" "$2" --fail-above relmse="$3"; }
for way in "--direct --spp 64" "--bounces 2 --series 16,1 --spp 1024"; do
    # shellcheck disable=SC2086 # words
    { tensor all $way; tensor left $way --light left; tensor right $way --light right; }
    expect 0 "$relume" edit all.safetensors -o all.exr --set paint.exponent=60
    expect 0 "$relume" edit left.safetensors right.safetensors -o sum.exr --set paint.exponent=60
    case $way in # 16 bins carry cos^9.5
    --direct*) [[ $err != *"too wide"* ]] || fail "a lobe that fits is warned of: $err" ;;
    *) [ "$(grep -c "too wide" <<<"$err")" = 1 ] || fail "not one warning for both lights: $err" ;;
    esac
    close_to all.exr sum.exr 1e-3
    # The same by a session, which is in the end where the changes lead, and as the factors say.
    expect 0 "$relume" edit left.safetensors right.safetensors -o dim.exr --light left=0.25 --light right=0,2,1 \
        --set paint.exponent=60 --variance --save-scene dim.xml
    cat >session.json <<'END_SESSION'
{"steps": [{"light": "left=7"}, {"set": "paint.exponent=60", "frames": 2, "write": true},
           {"light": ["left=0.25", "right=0,2,1"]}]}
END_SESSION
    expect 0 "$relume" edit left.safetensors right.safetensors -o last.exr --script session.json
    close_to dim.exr last.exr 1e-9
    expect 1 "$relume" compare dim.exr last.0002.exr --fail-above relmse=1e-3
    # Saved and path-traced.
    expect 0 "$relume" render dim.xml -o truth.exr --spp 256 --quiet \
        --max-depth "$([ "${way#--direct}" = "$way" ] && echo -1 || echo 2)"
    close_to truth.exr dim.exr 5e-3
done

expect 0 "$relume" tensor info left.safetensors
expect 1 "$relume" tensor merge left.safetensors right.safetensors -o both.safetensors
contains "$err" "light"
expect 1 "$relume" edit left.safetensors left.safetensors -o x.exr
contains "$err" "there is one of the same light"
expect 1 "$relume" edit all.safetensors left.safetensors -o x.exr
contains "$err" "both must be of one light"
expect 1 "$relume" edit left.safetensors -o x.exr --light right=2
contains "$err" "there are: left"
expect 1 "$relume" edit left.safetensors -o x.exr --light left=red
contains "$err" "expected NAME=R,G,B"
expect 1 "$relume" precompute edit scene.xml -o x.safetensors --edit paint --light top
contains "$err" "there are: left right"
finish
