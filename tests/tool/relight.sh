#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# relume relight: other lights, a turning environment, the lighting written back as a scene; wrong usage.
#
# usage: relight.sh RELUME
set -u
# LeakSanitizer itself dies now and then where PoCL has threads.
export ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0
relume=$(realpath "$1")
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"
cd "$folder" || exit 1

cat >scene.xml <<'END'
<scene version="3.0.0">
    <integrator type="path"/>
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="0,2,4" target="0,0.5,0" up="0,1,0"/></transform>
        <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="12"/></film>
    </sensor>
    <emitter type="constant" id="sky"><rgb name="radiance" value="0.5, 0.6, 0.8"/></emitter>
    <emitter type="point" id="lamp"><point name="position" value="1, 3, 1"/></emitter>
    <shape type="rectangle"><transform name="to_world"><scale value="3"/><rotate x="1" angle="-90"/></transform></shape>
    <shape type="sphere"><point name="center" value="0, 0.6, 0"/><float name="radius" value="0.6"/></shape>
</scene>
END
make_pfm env.pfm 64 32 3f800000 # radiance 1

expect 0 "$relume" precompute relight scene.xml -o lights.safetensors --basis lights --spp 256 --quiet
expect 0 "$relume" relight lights.safetensors -o a.exr --light lamp=4,8,2 --light sky=0.1 --save-scene new.xml
expect 0 "$relume" render new.xml -o b.exr --spp 256 --seed 1 --quiet
expect 0 "$relume" compare b.exr a.exr --fail-above relmse=0.01
# What was given by -D goes into the saved scene; the scene itself is not written over.
# shellcheck disable=SC2016 # $lamp is for the scene
sed 's|<integrator type="path"/>|&<default name="lamp" value="1"/>|
    s|value="1, 3, 1"/>|&<rgb name="intensity" value="$lamp"/>|' scene.xml >given.xml
expect 0 "$relume" precompute relight given.xml -o given.safetensors --basis lights --spp 16 -D lamp=7 --quiet
expect 0 "$relume" relight given.safetensors -o given.exr --light sky=0.5 --save-scene new.xml
expect 0 "$relume" render new.xml -o b.exr --spp 256 --quiet
expect 0 "$relume" compare b.exr given.exr --fail-above relmse=0.01
expect 1 "$relume" relight given.safetensors --light sky=0.5 --save-scene given.xml
contains "$err" "own scene"
# Tensors of other paths are not added.
expect 0 "$relume" precompute relight given.xml -o other.safetensors --spp 16 -D lamp=7 --seed 1 --max-depth 2 --quiet
expect 1 "$relume" tensor merge given.safetensors other.safetensors -o all.safetensors
expect 0 "$relume" relight lights.safetensors -o plain.exr
expect 1 "$relume" compare plain.exr a.exr --fail-above relmse=0.1
expect 1 "$relume" relight lights.safetensors --light sun=2 --save-scene none.xml
expect 2 "$relume" relight lights.safetensors
expect 1 "$relume" relight lights.safetensors -o out.exr --frames 3
contains "$err" "do not turn"
expect 1 "$relume" relight lights.safetensors -o out.exr --rotate 3
contains "$err" "--rotate need"
expect 1 "$relume" relight lights.safetensors -o out.exr --light lump=3
contains "$err" "there are: sky lamp"
expect 0 "$relume" tensor info lights.safetensors
contains "$out" "lights: sky lamp"
expect 0 "$relume" info lights.safetensors
contains "$out" "lights: sky lamp"
# The layers of an export add up to the picture; harmonics and cells have names.
expect 0 "$relume" tensor export lights.safetensors -o layers.exr
layers=$("$relume" info layers.exr --json)
expect 0 "$relume" info plain.exr --json
python3 - "$layers" "$out" <<'END' || fail "the exported layers do not add up"
import json, sys
layers, picture = ({c["name"]: c["mean"] for c in json.loads(a)["channels"]} for a in sys.argv[1:])
assert {"sky.R", "lamp.G", "fixed.B"} <= set(layers), layers
for k in "RGB":
    whole = sum(mean for name, mean in layers.items() if name.endswith(k))
    assert abs(whole - picture[k]) < 1e-5 * picture[k], (whole, picture[k])
END
expect 2 "$relume" tensor export lights.safetensors -o layers.exr --half
# What would have no effect is refused.
for wrong in "--turn 3" "--frames 3 --variance" "--scene scene.xml"; do
    # shellcheck disable=SC2086 # words
    expect 2 "$relume" relight lights.safetensors -o out.exr $wrong
done
expect 2 "$relume" relight lights.safetensors --save-scene new.xml --time
for wrong in "relight --edit a" "relight --bounces 2" "relight --direct" "edit --basis sh:2" "edit --lights 40" \
    "edit --direct --series 8" "edit --direct --max-depth 3" \
    "edit --edit sky --integrator aov"; do
    # shellcheck disable=SC2086 # words
    expect 2 "$relume" precompute ${wrong%% *} scene.xml -o out.safetensors ${wrong#* }
    contains "$err" "has no effect on"
done
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >patch.obj
sed 's|</scene>|<shape type="obj" id="patch"><string name="filename" value="patch.obj"/></shape>&|' scene.xml >patch.xml
expect 1 "$relume" precompute relight patch.xml -o out.safetensors --vertices patch --integrator direct
contains "$err" 'integrator "direct" cannot serve sensor "vertices"; path and volpath can'
# Layers of the first hit are no light; the picture beside them is.
expect 1 "$relume" precompute relight scene.xml -o out.safetensors --integrator aov
contains "$err" 'integrator "aov" traces no light'
sed 's|<integrator type="path"/>|<integrator type="aov">&</integrator>|' scene.xml >nested.xml
expect 0 "$relume" precompute relight nested.xml -o nested.safetensors --spp 4 --quiet
if [ -e out.exr ] || [ -e out.safetensors ]; then fail "something was written after an error"; fi

expect 0 "$relume" precompute relight scene.xml -o cells.safetensors --basis haar:8x4 --spp 256 --quiet
expect 0 "$relume" relight cells.safetensors -o a.exr --env env.pfm --rotate 30 --save-scene new.xml
contains "$(cat new.xml)" 'type="envmap"'
expect 0 "$relume" render new.xml -o b.exr --spp 256 --seed 1 --quiet
expect 0 "$relume" compare b.exr a.exr --fail-above relmse=0.01
# Under even light all frames are the same.
expect 0 "$relume" relight cells.safetensors -o turn.exr --env env.pfm --frames 3 --terms 8
for frame in turn.0001.exr turn.0003.exr; do
    expect 0 "$relume" compare a.exr $frame --fail-above relmse=1e-8
done
expect 0 "$relume" relight cells.safetensors -o turn.exr --frames 2 --turn 90 --json --quiet
near "$(tail -n 1 <<<"$out")" frame 2

# The scene's own environment turns too: as the saved scene has it, and the sun's cell by two columns.
sed 's|<emitter type="constant".*/emitter>|<emitter type="sunsky" id="sky"><float name="hour" value="9"/>\
    <transform name="to_world"><rotate x="1" angle="-90"/></transform></emitter>|' scene.xml >sun.xml
for basis in pixels:8x4 sh:3 daub4:8x4; do
    expect 0 "$relume" precompute relight sun.xml -o sun.safetensors --basis $basis --spp 64 --quiet
    expect 0 "$relume" relight sun.safetensors -o a.exr --rotate 90 --save-scene new.xml
    expect 0 "$relume" precompute relight new.xml -o new.safetensors --basis $basis --spp 64 --quiet
    expect 0 "$relume" relight new.safetensors -o b.exr
    expect 0 "$relume" compare b.exr a.exr --fail-above relmse=1e-4
    expect 0 "$relume" tensor export sun.safetensors -o layers.exr
    expect 0 "$relume" relight sun.safetensors -o b.exr
    expect 1 "$relume" compare b.exr a.exr --fail-above relmse=1e-2
done
expect 0 "$relume" precompute relight sun.xml -o sun.safetensors --basis lights --spp 16 --quiet
expect 0 "$relume" relight sun.safetensors --light sky=0.5 --save-scene new.xml
contains "$(cat new.xml)" 'name="sky_scale" value="0.5"'
finish
