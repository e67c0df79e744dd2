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
expect 0 "$relume" relight lights.safetensors -o plain.exr
expect 1 "$relume" compare plain.exr a.exr --fail-above relmse=0.1
expect 1 "$relume" relight lights.safetensors --light sun=2 --save-scene none.xml
expect 2 "$relume" relight lights.safetensors
expect 2 "$relume" relight lights.safetensors -o out.exr --frames 3

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
finish
