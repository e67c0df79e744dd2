#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# relume help and --help: every entry of every registry explains itself, the elements it shows can
# be read and rendered, wrong names are usage errors, the README names all entries, and the examples
# of the subcommands run.
#
# usage: help.sh RELUME
set -u
# LeakSanitizer itself dies now and then where PoCL has threads.
export ASAN_OPTIONS=${ASAN_OPTIONS:+$ASAN_OPTIONS:}detect_leaks=0
relume=$(realpath "$1")
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
materials=$(dirname "$relume")/../tests # files that the build makes
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"

# names KIND: its entries, one a line
names() {
    "$relume" help "$1" | sed -n 's/^  \([a-z0-9_]*\) .*/\1/p'
}

# element: the XML of the last help
element() {
    sed -n '/^In a scene, with defaults:$/,$p' <<<"$out" | sed -n '/^</,$p' | sed '/^$/,$d'
}

make_pfm "$folder/picture.pfm" 8 4 3f000000

# Writes a scene around the parts given by name; what is not given is plain.
# scene [shapes=XML] [lights=XML] [film=XML] [integrator=XML] [sensor=XML]
scene() {
    local shapes='<shape type="sphere"/>' lights='<emitter type="constant"/>'
    local integrator='<integrator type="path"><integer name="max_depth" value="3"/></integrator>'
    local film='<film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="4"/></film>'
    local part sensor=
    for part; do
        local "${part%%=*}"="${part#*=}"
    done
    [ -n "$sensor" ] || sensor="<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/>
        <transform name=\"to_world\"><lookat origin=\"0 0 4\" target=\"0 0 0\" up=\"0 1 0\"/></transform>
        $film</sensor>"
    cat >"$folder/scene.xml" <<END
<scene version="3.0.0">$integrator $sensor $shapes $lights</scene>
END
}

# The scene that was written gives a picture without NaN.
renders() {
    expect 0 "$relume" render "$folder/scene.xml" -o "$folder/out.exr" --size 4x4 --spp 2 --quiet \
        --threads 1 --json
    contains "$out" '"rejected_samples": 0'
}

# inside MEDIUM: a scene with a ball of it
inside() {
    scene shapes="<shape type=\"sphere\"><bsdf type=\"null\"/>$1</shape>" integrator='<integrator type="volpath"/>'
}

# put KIND XML: a scene in which the element stands where it belongs
put() {
    local kind=$1 xml=$2
    case $kind in
    bsdf) scene shapes="<shape type=\"sphere\">$xml</shape>" ;;
    texture)
        scene shapes="<shape type=\"ply\"><string name=\"filename\" value=\"$root/data/meshes/patch_text.ply\"/>
            <bsdf type=\"diffuse\">${xml/<texture /<texture name=\"reflectance\" }</bsdf></shape>"
        ;;
    spectrum) scene lights="<emitter type=\"constant\">${xml/<spectrum /<spectrum name=\"radiance\" }</emitter>" ;;
    shape | mesh) scene shapes="$xml" ;;
    light) scene lights="$xml" ;;
    sensor) scene sensor="$xml" integrator="<integrator type=\"path\"/>" ;;
    film) scene film="$xml" ;;
    filter | sampler)
        scene sensor="<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/>
            <film type=\"hdrfilm\">$([ "$kind" = sampler ] || echo "$xml")</film>
            $([ "$kind" = filter ] || echo "$xml")</sensor>"
        ;;
    medium) inside "${xml/<medium /<medium name=\"interior\" }" ;;
    phase) inside "<medium type=\"homogeneous\" name=\"interior\">$xml</medium>" ;;
    volume) inside "<medium type=\"heterogeneous\" name=\"interior\">${xml/<volume /<volume name=\"sigma_t\" }</medium>" ;;
    integrator) scene integrator="$xml" ;;
    esac
}

# fill KIND NAME XML: placeholders of an example as files and names that exist
fill() {
    local xml=$3 format
    case $1/$2 in
    mesh/*)
        format=$(cd "$root/data/meshes" && echo patch*."$2")
        xml=${xml//FILE/$root/data/meshes/${format%% *}}
        ;;
    shape/instance)
        xml="<shape type=\"shapegroup\" id=\"g\"><shape type=\"sphere\"/></shape>
            ${xml/<\/shape>/<ref id=\"g\"\/><\/shape>}"
        ;;
    sensor/irradiancemeter | sensor/texels | sensor/vertices) xml="<shape type=\"rectangle\">$xml</shape>" ;;
    light/area) xml="<shape type=\"sphere\">$xml</shape>" ;;
    bsdf/merl) xml=${xml//FILE/$materials/table.binary} ;;
    bsdf/measured) xml=${xml//FILE/$materials/film.bsdf} ;;
    bsdf/goniometer) xml=${xml//FILE/$materials/sheet.transfer} ;;
    bsdf/window) xml=${xml//FILE/$materials/matrix.xml} ;;
    bsdf/editable) xml=$(grep -v '"FILE"' <<<"$xml") ;;
    light/ies) xml=${xml//FILE/$root/data/lights/type_c.ies} ;;
    volume/gridvolume) xml=${xml//FILE/$root/data/volumes/patch_float.vol} ;;
    texture/mesh_attribute) xml=${xml//TEXT/vertex_color} ;;
    sampler/*) xml=${xml//\"sample_count\" value=\"0\"/\"sample_count\" value=\"4\"} ;;
    spectrum/*) xml=${xml//TEXT/400 700} ;;
    esac
    echo "${xml//FILE/$folder/picture.pfm}"
}

readme=$(cat "$root/README.md")
count=0
for kind in shape mesh bsdf texture light medium phase volume sensor film filter sampler integrator spectrum; do
    for name in $(names $kind); do
        count=$((count + 1))
        expect 0 "$relume" help $kind "$name"
        contains "$out" "type=\"$name\""
        [ $kind = bsdf ] && contains "$out" "Claims, which the tests check:"
        contains "$readme" "\`$name\`"
        # Under sanitizers a render takes seconds: every fourth entry.
        [ -z "${RELUME_TEST_SANITIZED:-}" ] || [ $((count % 4)) = 0 ] || continue
        [ $kind/"$name" != integrator/stored ] || continue # needs a tensor of the picture's size: study.sh
        put $kind "$(fill $kind "$name" "$(element)")"
        renders
    done
done
[ $count -ge 83 ] || fail "only $count entries are explained"

expect 0 "$relume" help
contains "$out" "roughconductor"
# What the overview lists under a kind is an entry of it.
overview=$out
kind=
while read -r first rest; do
    if [[ $first == *: ]]; then
        kind=${first%:}
    elif [ -n "$kind" ] && [ "$first" != see ]; then
        for name in $first $rest; do
            expect 0 "$relume" help "$kind" "$name"
        done
    fi
done < <(tail -n +2 <<<"$overview")
for name in obj ply serialized; do
    expect 0 "$relume" help mesh $name
    text=$out
    expect 0 "$relume" help shape $name
    [ "$out" = "$text" ] || fail "help shape $name differs from help mesh $name"
done
expect 0 "$relume" help bsdf roughconductor
contains "$out" "one of beckmann, ggx [beckmann]"
contains "$out" "number or texture from 0 to 1000 [0.1]"
contains "$out" "visible normals are always sampled"
expect 0 "$relume" help bsdf principled
contains "$out" "main_specular_sampling_rate number"
expect 0 "$relume" help sunsky
contains "$out" "(degrees)"
expect 0 "$relume" help emitter spot
expect 0 "$relume" help rfilter box
expect 0 "$relume" help material Au
for format in gltf mtl pbrt; do
    expect 0 "$relume" help format $format
    contains "$readme" "$out"
done
expect 0 "$relume" help material
contains "$out" "bk7"

expect 2 "$relume" help bsdf roughconductr
contains "$err" "'roughconductor'"
expect 2 "$relume" help bsfd
contains "$err" "'bsdf'"
expect 2 "$relume" help bsfd diffuse
contains "$err" "'bsdf'"
expect 2 "$relume" help material Agg
contains "$err" "'Ag'"
expect 2 "$relume" help bsdf diffuse more
expect 2 "$relume" help nothing-like-it

for name in $(names subcommand); do
    expect 0 "$relume" "$name" --help
    contains "$out" "usage: relume $name"
    text=$out
    expect 0 "$relume" "$name" -h
    [ "$out" = "$text" ] || fail "$name -h differs from --help"
    expect 0 "$relume" help "$name"
    [ "$out" = "$text" ] || fail "help $name differs from --help"
    contains "$readme" "relume $name"
    expect 2 "$relume" "$name" --no-such-option
    contains "$err" "--no-such-option"
done
expect 0 "$relume" --help
contains "$out" "Exit codes"
expect 0 "$relume" render --help
for name in $(names integrator) $(names sampler); do
    contains "$out" "  $name "
done
contains "$out" "relume help"
expect 2 "$relume" render "$folder/scene.xml" -o "$folder/out.exr" --integrator pth
contains "$err" "'path'"
expect 2 "$relume" render "$folder/scene.xml" -o "$folder/out.exr" --sampler sobel
contains "$err" "'sobol'"
expect 2 "$relume" render "$folder/scene.xml" -o "$folder/out.exr" --aov colour
expect 2 "$relume" render "$folder/scene.xml"
expect 1 "$relume" render "$folder/none.xml" -o "$folder/out.exr"

# The examples, as they stand, on small files of the names they use.
cd "$folder" || exit 1
scene
# shellcheck disable=SC2016 # a parameter of the scene
sed 's/<scene version="3.0.0">/&<default name="spp" value="4"\/>/
    s/<film/<sampler type="sobol"><integer name="sample_count" value="$spp"\/><\/sampler>&/' \
    scene.xml >with_spp.xml && mv with_spp.xml scene.xml
cp "$root/data/meshes/patch_text.ply" bunny.ply
cp scene.xml room.xml
sed -i 's/<shape type="sphere"\/>/<bsdf type="diffuse" id="floor"\/><shape type="sphere"><ref id="floor"\/><\/shape>/
    s/<emitter type="constant"\/>/<emitter type="constant" id="sky"\/><emitter type="point" id="lamp"\/>/' room.xml
cp scene.xml car.xml
cp "$materials/film.bsdf" . && "$relume" brdf diffuse --to gold.binary >log
"$relume" render scene.xml -o grace.exr --size 32x16 --quiet
"$relume" precompute relight car.xml -o car.safetensors --basis pixels:32x16 --spp 64 --quiet
"$relume" precompute relight room.xml -o lights.safetensors --basis lights --spp 64 --quiet
cp "$materials/linear.safetensors" tea.safetensors
cp "$materials/more.safetensors" .
cat >config.ocio <<END
ocio_profile_version: 1
roles: {default: lin_rec709}
displays: {Monitor: [!<View> {name: Filmic, colorspace: lin_rec709}]}
colorspaces: [!<ColorSpace> {name: lin_rec709}]
END
echo '{"steps": [{"set": "cup.exponent=40"}]}' >session.json
"$relume" render scene.xml -o big.exr --size 32x32 --quiet
"$relume" render scene.xml -o room.exr --size 16x16 --aov albedo --variance --quiet
for name in $(names subcommand); do
    for picture in ref ref_var out; do
        cp room.exr $picture.exr # an example may have written one of them
    done
    while read -r line; do
        # shellcheck disable=SC2086 # words of the example
        "$relume" ${line#relume } >log 2>&1
        code=$? # 1 is an answer where an example asks whether something holds
        [ $code -eq 0 ] || [[ $code -eq 1 && $line == *--fail-above* ]] ||
            grep -q "Open Image Denoise is not installed" log || fail "exit code $code: $line: $(cat log)"
    done < <("$relume" "$name" --help | sed -n '/^Examples:$/,$p' | sed -n 's/^  relume/relume/p')
done
finish
