#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# relume render: options, refusals, attributes, stopping.
#
# usage: render.sh RELUME
set -u
relume=$1
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"

scene=$folder/sky.xml picture=$folder/sky.exr
# make_scene NAME BODY
make_scene() {
    cat >"$folder/$1" <<END
<scene version="3.0.0">
<default name="radiance" value="1"/>
<integrator type="path"/>
<emitter type="constant" id="sky"><rgb name="radiance" value="\$radiance"/></emitter>
<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="16"/>
<integer name="height" value="12"/><rfilter type="box"/></film></sensor>
$2
</scene>
END
}
make_scene sky.xml ''

# attribute JSON NAME: the text of an attribute, as `info --json` gives it
attribute() {
    python3 -c 'import json, sys; print(json.loads(sys.argv[1])["attributes"][sys.argv[2]])' "$@"
}

# channels JSON: names, sorted
channels() {
    python3 -c 'import json, sys; print(*sorted(c["name"] for c in json.loads(sys.argv[1])["channels"]))' "$1"
}

# Wrong usage: 2; a file that is not there: 1. Both name what was found.
expect 2 "$relume" render "$scene" -o "$picture" --spq 4
contains "$err" "--spq"
expect 2 "$relume" render "$scene" -o "$picture" --colour
contains "$err" "--colour"
expect 2 "$relume" render "$scene"
contains "$err" "--output"
expect 2 "$relume" render "$scene" -o "$picture" --spp many
contains "$err" "many"
expect 2 "$relume" render "$scene" -o "$picture" -D radiance
contains "$err" "NAME=VALUE"
expect 2 "$relume" render "$scene" -o "$picture" -D radiance=1 -D radiance=2
contains "$err" '-D radiance=2: "radiance" is given twice, as 1 before'
expect 1 "$relume" render "$folder/none.xml" -o "$picture"
contains "$err" "$folder/none.xml"
expect 1 "$relume" render "$scene" -o "$picture" --crop 0,0,17,12
contains "$err" "0,0,17,12"
expect 2 "$relume" render "$scene" -o "$picture" --sampler sobl
contains "$err" "sobol"
expect 2 "$relume" render "$scene" -o "$picture" --aov albdo
contains "$err" "albedo"
[ ! -e "$picture" ] || fail "a refused render wrote a file"

sed 's|<film|<transform name="to_world"><lookat origin="0 0 1e50" target="0 0 0"/></transform>&|' \
    "$scene" >"$folder/beyond.xml"
expect 1 "$relume" render "$folder/beyond.xml" -o "$picture"
contains "$err" "beyond.xml:5: perspective: stands 1e+50 from the scene, expected less than 1e+18"
sed 's|type="perspective">|type="radiancemeter"><point name="origin" x="1e19"/><vector name="direction" z="1"/>|' \
    "$scene" >"$folder/beyond.xml"
expect 1 "$relume" render "$folder/beyond.xml" -o "$picture"
contains "$err" "beyond.xml:5: radiancemeter: stands 1e+19 from the scene"
sed -i 's|<vector name="direction" z="1"/>||' "$folder/beyond.xml"
expect 1 "$relume" render "$folder/beyond.xml" -o "$picture"
contains "$err" "beyond.xml:5: radiancemeter: an origin without direction, expected both or to_world"

# What cannot be written is known before the first sample, not after an hour.
expect 1 timeout 20 "$relume" render "$scene" -o "$folder/none/sky.exr" --spp 1000000000
contains "$err" "$folder/none"
mkdir "$folder/folder.exr"
expect 1 timeout 20 "$relume" render "$scene" -o "$folder/folder.exr" --spp 1000000000
contains "$err" "$folder/folder.exr"

# What is there and may not be replaced stays.
cp "$scene" "$folder/kept.exr"
chmod 444 "$folder/kept.exr"
expect 1 timeout 20 "$relume" render "$scene" -o "$folder/kept.exr" --spp 1000000000
contains "$err" "write-protected"
cmp -s "$scene" "$folder/kept.exr" || fail "a write-protected file was replaced"
mkfifo "$folder/pipe.exr"
expect 1 timeout 20 "$relume" render "$scene" -o "$folder/pipe.exr" --spp 1000000000
contains "$err" "not a regular file"
# A good run: the figures are JSON, the file says what made it.
expect 0 "$relume" render "$scene" -o "$picture" --spp 4 --seed 7 -D radiance=0.5 --json
near "$out" samples 4
near "$out" paths $((16 * 12 * 4))
near "$out" truncated_paths 0
contains "$out" '"stopped": false'
near "$out" rejected_samples 0
near "$out" overflows 0
near "$out" half_overflows 0
expect 0 "$relume" info "$picture" --json
info=$out
near "$info" width 16
near "$info" height 12
near "$info" channels.1.min 0.5
near "$info" channels.1.max 0.5
[ "$(attribute "$info" relume.samples)" = 4.0 ] || fail "relume.samples"
[ "$(attribute "$info" relume.seed)" = 7.0 ] || fail "relume.seed"
[ "$(attribute "$info" relume.colourSpace)" = "linear Rec.709" ] || fail "relume.colourSpace"
contains "$(attribute "$info" relume.command)" "render $scene -o $picture --spp 4"
attribute "$info" relume.version >/dev/null || fail "relume.version"
attribute "$info" relume.seconds >/dev/null || fail "relume.seconds"
hash=$(attribute "$info" relume.sceneHash)
[ ${#hash} = 16 ] || fail "relume.sceneHash is '$hash'"
expect 0 "$relume" render "$scene" -o "$picture" --spp 4 --quiet
[ -z "$out$err" ] || fail "--quiet printed: $out$err"

# The hash follows the scene's files.
make_scene other.xml '<!-- another scene -->'
expect 0 "$relume" render "$folder/other.xml" -o "$folder/other.exr" --spp 1
expect 0 "$relume" info "$folder/other.exr" --json
[ "$(attribute "$out" relume.sceneHash)" != "$hash" ] || fail "two scenes have the same hash"

# Size, crop, layers.
expect 0 "$relume" render "$scene" -o "$picture" --spp 16 --size 10x8 --crop 2,3,9,8 \
    --aov N,Z --variance --light-groups --paths --threads 3
expect 0 "$relume" info "$picture" --json
near "$out" width 7
near "$out" height 5
names=" $(channels "$out") "
for channel in R G B N.X N.Y N.Z Z variance.R variance.G variance.B sky.R rest.B emission.G \
    direct_diffuse.R indirect_specular.B; do
    [[ $names == *" $channel "* ]] || fail "no channel $channel in:$names"
done

# Beyond the range of half: counted, said, and the picture is still written.
expect 0 "$relume" render "$scene" -o "$picture" --spp 1 --half -D radiance=1e6 --json
near "$out" half_overflows $((16 * 12 * 3))
contains "$err" "$((16 * 12 * 3)) values were beyond the range of half"
expect 0 "$relume" render "$scene" -o "$picture" --samples 0:64 -D radiance=1e6
expect 0 "$relume" merge "$picture" -o "$folder/united.exr" --half --json
near "$out" half_overflows $((16 * 12 * 3))
contains "$err" "$((16 * 12 * 3)) values were beyond the range of half"

# Beyond the range of float, as the square of a radiance of 1e25 is: the same.
expect 0 "$relume" render "$scene" -o "$picture" --spp 1 --integrator moment -D radiance=1e25 --json
near "$out" overflows $((16 * 12 * 3))
contains "$err" "$((16 * 12 * 3)) values were beyond the range of 32 bits"

# The clamp: nothing where nothing is above it, else as much as it says, in the picture as in JSON.
make_scene clamp.xml '<shape type="sphere"><boolean name="flip_normals" value="true"/>
<bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf><emitter type="area"/></shape>'
clamp() {
    expect 0 "$relume" render "$folder/clamp.xml" -o "$folder/$1.exr" --spp 64 --json "${@:2}"
}
clamp free
[[ $err$out != *clamp* ]] || fail "a clamp is spoken of where there is none"
clamp high --clamp 1000
near "$out" clamped_share 0
expect 0 "$relume" compare "$folder/free.exr" "$folder/high.exr" --fail-above mse=0
clamp low --clamp 0.1
contains "$err" "--clamp 0.1 removed"
share=$(python3 -c 'import json, sys; print(json.loads(sys.argv[1])["clamped_share"])' "$out")
expect 0 "$relume" info "$folder/low.exr" --json
low=$out
near "{\"share\": $(attribute "$low" relume.clampedShare)}" share "$share"
near "{\"clamp\": $(attribute "$low" relume.clamp)}" clamp 0.1
expect 0 "$relume" info "$folder/free.exr" --json
python3 - "$low" "$out" "$share" <<'END' || fail "what is kept and what is cut off are not the whole"
import json, sys
low, free = ({c["name"]: c["mean"] for c in json.loads(a)["channels"]} for a in sys.argv[1:3])
cut = low["clamped.G"]
print(low["G"], cut, free["G"])
good = cut > 0 and abs(low["G"] + cut - free["G"]) < 1e-5
sys.exit(not (good and abs(cut / free["G"] - float(sys.argv[3])) < 1e-5))
END

# A disk without room, where this user may mount one.
mkdir "$folder/small"
if mount -t tmpfs -o size=256k none "$folder/small" 2>/dev/null; then
    cp "$scene" "$folder/small/x.exr"
    for options in "--size 280x280 --spp 2" "--size 512x256 --spp 1000000000" \
        "--size 250x250 --spp 2 --light-groups --paths --variance" "--size 512x512 --spp 1000000000 --checkpoint 1"; do
        # shellcheck disable=SC2086 # words
        expect 1 timeout 20 "$relume" render "$folder/clamp.xml" -o "$folder/small/x.exr" $options
        contains "$err" "x.exr"
        cmp -s "$scene" "$folder/small/x.exr" || fail "a full disk cost a picture"
        [ "$(ls "$folder/small")" = x.exr ] || fail "left on a full disk: $(ls "$folder/small")"
    done
    expect 0 "$relume" render "$scene" -o "$folder/fits.exr" --size 8x8 --spp 1
    head -c 256k /dev/zero >"$folder/small/rest" 2>/dev/null
    expect 1 "$relume" tonemap "$folder/fits.exr" -o "$folder/small/x.png"
    contains "$err" "x.png"
    [ ! -e "$folder/small/x.png" ] || fail "an empty PNG was written"
    umount "$folder/small"
fi

# A file that may not grow (here 4 KB) is told of in the same way.
cp "$scene" "$folder/x.exr"
for options in --checkpoint=1 --preview=0.1 --half; do
    code=0
    err=$( (ulimit -f 4 && timeout 20 "$relume" render "$folder/clamp.xml" -o "$folder/x.exr" --size 96x96 \
        --spp 64 "$options") 2>&1 >/dev/null) || code=$?
    [ $code = 1 ] || fail "exit code $code beyond the size of a file: $err"
    contains "$err" "x.exr"
    cmp -s "$scene" "$folder/x.exr" || fail "a limit of size cost a picture"
    left=$(find "$folder" -name 'x.exr*tmp*')
    [ -z "$left" ] || fail "left behind: $left"
done

# Mistakes in a scene name file, line and the nearest name; --lenient takes unknown parameters.
make_scene bad.xml '<shape type="sphere"><float name="radios" value="1"/></shape>'
expect 1 "$relume" render "$folder/bad.xml" -o "$picture"
contains "$err" "bad.xml:7"
contains "$err" "radius"
expect 0 "$relume" render "$folder/bad.xml" -o "$picture" --lenient --spp 1
contains "$err" "radios"

# stopped SIGNAL COMMAND...: sends the signal after a second; 0 is the time the command then took.
stopped() {
    local signal=$1 pid
    shift
    "$@" >"$folder/out" 2>"$folder/err" &
    pid=$!
    sleep 1
    local start=$EPOCHREALTIME
    kill "-$signal" $pid
    { wait $pid; } 2>/dev/null
    code=$?
    seconds=$(python3 -c "print($EPOCHREALTIME - $start)")
    out=$(cat "$folder/out") err=$(cat "$folder/err")
}

# Ctrl-C: within two seconds there is a picture in which all pixels have equally many samples; else
# they were not all exactly 1. The pixels are many, so that a pass takes longer than a stop may.
for signal in INT TERM; do
    rm -f "$picture"
    stopped $signal "$relume" render "$scene" -o "$picture" --spp 1000000000 --size 1024x768 --json
    echo "SIG$signal: stopped after $seconds s"
    [ "$code" = 3 ] || fail "exit code $code after SIG$signal, expected 3: $err"
    python3 -c "import sys; sys.exit($seconds > 2)" || fail "it took $seconds s to stop"
    contains "$out" '"stopped": true'
    expect 0 "$relume" info "$picture" --json
    near "$out" channels.0.min 1
    near "$out" channels.0.max 1
    near "$out" channels.0.mean 1
    python3 -c "import sys; sys.exit(not 0 < $(attribute "$out" relume.samples) < 1e9)" ||
        fail "relume.samples is $(attribute "$out" relume.samples)"
done

# The same with layers, which are made while they are written: each is whole.
stopped INT "$relume" render "$scene" -o "$picture" --spp 1000000000 --size 320x200 --light-groups --paths \
    --variance
echo "with layers: stopped after $seconds s"
[ "$code" = 3 ] || fail "exit code $code after SIGINT with layers, expected 3: $err"
python3 -c "import sys; sys.exit($seconds > 2)" || fail "it took $seconds s to stop with layers"
expect 0 "$relume" info "$picture" --json
python3 - "$out" <<'END' || fail "layers of a stopped render are not what they were in memory"
import json, sys
one = {layer + c for layer in ("", "sky.", "emission.") for c in "RGB"}
channels = json.loads(sys.argv[1])["channels"]
wrong = [c for c in channels if c["min"] != c["max"] or abs(c["min"] - (c["name"] in one)) > 1e-30]
print(len(channels), "channels, wrong:", wrong)
sys.exit(len(channels) < 30 or wrong != [])
END

# Known before an hour of rendering: names of layers, of files; a format that is none.
for name in rest variance; do
    make_scene clash.xml "<emitter type='point' id='$name'/>"
    expect 1 "$relume" render "$folder/clash.xml" -o "$folder/clash.exr" --light-groups --spp 1000000
done
contains "$err" 'clash.xml:7: --light-groups: "variance" is the name of another layer'
# An emitter, a group: what cannot be a layer; the longest name that can.
long=$(printf 'n%.0s' {1..61})
for light in "<emitter type='point' id='${long}n'/>" "<emitter type='point' id='${long}na'/><emitter type='point' id='${long}nb'/>" \
    "<emitter type='point'><string name='group' value=''/></emitter>" "<emitter type='point' id='CryptoObject00'/>"; do
    make_scene clash.xml "$light"
    expect 1 timeout 20 "$relume" render "$folder/clash.xml" -o "$folder/clash.exr" --light-groups --cryptomatte object \
        --spp 1000000000
    contains "$err" "clash.xml:7: --light-groups: \""
    contains "$err" "expected another id of the light, or a \`group\`, of 1 to 61 bytes"
done
make_scene clash.xml "<emitter type='point' id='$long'/>"
expect 0 "$relume" render "$folder/clash.xml" -o "$folder/clash.exr" --light-groups --cryptomatte object --spp 1
for name in sky.png sky.txt sky; do
    expect 2 "$relume" render "$scene" -o "$folder/$name"
    contains "$err" "--output: found '$folder/$name', expected a name that ends in .exr"
done
sed 's/<film type="hdrfilm">/&<string name="pixel_format" value="rbg"\/>/' "$scene" >"$folder/format.xml"
expect 1 "$relume" render "$folder/format.xml" -o "$folder/format.exr"
contains "$err" 'pixel_format" is "rbg", expected one of rgb'

# More lights than layers are written: refused, with what they would take at this size, unless grouped.
lamps() {
    local i
    for ((i = 0; i < $1; i++)); do
        echo "<emitter type='point' id='lamp$i'>${2:-}</emitter>"
    done
}
make_scene lamps.xml "$(lamps 64)"
lamps=(render "$folder/lamps.xml" -o "$folder/lamps.exr" --light-groups)
expect 1 timeout 20 "$relume" "${lamps[@]}" --spp 1000000000
contains "$err" "$folder/lamps.xml: --light-groups would take 65 layers (0.0 GiB while rendering); at most 64 are written: give the lights"
expect 1 timeout 20 "$relume" "${lamps[@]}" --spp 1000000000 --size 8000x6000
gib=${err#*65 layers (} gib=${gib%% GiB*}
echo "65 layers of 8000 x 6000 pixels: $gib GiB"
python3 -c "import sys; sys.exit(not 8000 * 6000 * 66 * 24 / 2**30 <= $gib)" ||
    fail "66 layers of 8000 x 6000 x 3 doubles do not fit into $gib GiB"
[ ! -e "$folder/lamps.exr" ] || fail "a refused render wrote a file"
make_scene lamps.xml "$(lamps 63)"
expect 0 "$relume" "${lamps[@]}" --spp 1
make_scene lamps.xml "$(lamps 64 "<string name='group' value='street'/>")"
expect 0 "$relume" "${lamps[@]}" --spp 1
expect 0 "$relume" info "$folder/lamps.exr" --json
names=" $(channels "$out") "
[[ $names == *" street.R "* && $names != *" lamp0.R "* ]] || fail "64 lights of one group:$names"

# Paths that never end are cut, counted and told: nothing here takes light away.
make_scene white.xml '<shape type="sphere"><boolean name="flip_normals" value="true"/>
<bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf></shape>'
sed 's/<integrator type="path"\/>/<integrator type="path"><integer name="rr_depth" value="1000000"\/><\/integrator>/' \
    "$folder/white.xml" >"$folder/endless.xml"
paths=$((16 * 12))
expect 0 "$relume" render "$folder/endless.xml" -o "$picture" --spp 1 --seed 1 --json
near "$out" truncated_paths $paths
contains "$err" "$paths of $paths paths met the cap of 4096 events and were cut: the picture is too dark"

# A run that is killed leaves the old file.
cp "$picture" "$folder/old.exr"
stopped KILL "$relume" render "$scene" -o "$picture" --spp 1000000000
cmp -s "$picture" "$folder/old.exr" || fail "a killed run changed the old file"

finish
