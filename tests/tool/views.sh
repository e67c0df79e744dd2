#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# relume tonemap with views of OpenColorIO: a configuration written here, whose views are known
# functions; what it lacks is named together with what it has.
#
# usage: views.sh RELUME
set -u
relume=$1
# shellcheck source=tests/tool/pictures.sh
. "$(dirname "${BASH_SOURCE[0]}")/pictures.sh"
unset OCIO

grey=$folder/grey.pfm png=$folder/out.png config=$folder/config.ocio
make_pfm "$grey" 5 7 3e800000 # 0.25

# make_config LINEAR ROLES: the name of the linear space, and more roles
make_config() {
    cat >"$config" <<END_CONFIG
ocio_profile_version: 2
strictparsing: true
roles:
  default: raw
  scene_linear: $1
$2
file_rules:
  - !<Rule> {name: Default, colorspace: default}
displays:
  Monitor:
    - !<View> {name: Root, colorspace: root}
    - !<View> {name: Plain, colorspace: raw}
  Cinema screen:
    - !<View> {name: Halved, colorspace: half}
colorspaces:
  - !<ColorSpace> {name: raw, isdata: true}
  - !<ColorSpace> {name: $1}
  - !<ColorSpace>
    name: root
    from_scene_reference: !<ExponentTransform> {value: [0.5, 0.5, 0.5, 1]}
  - !<ColorSpace>
    name: half
    from_scene_reference: !<MatrixTransform> {matrix: [0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 0.5, 0, 0, 0, 0, 1]}
END_CONFIG
}

# shows VALUE OPTION...: the 8-bit value that 0.25 becomes
shows() {
    local value=$1
    shift
    expect 0 "$relume" tonemap "$grey" -o "$png" "$@"
    expect 0 "$relume" info "$png" --json
    near "$out" channels.0.mean "$(python3 -c "print($value / 255)")"
    near "$out" channels.2.max "$(python3 -c "print($value / 255)")"
}

make_config lin_rec709 ""
shows 128 --ocio "$config" # 0.25^0.5, the default display and view
shows 64 --ocio "$config" --view Plain
shows 32 --ocio "$config" --display "Cinema screen"
shows 64 --ocio "$config" --display "Cinema screen" --exposure 1
shows 8 --ocio "$config" --from root --display "Cinema screen" # 0.25^2 / 2
OCIO=$config shows 64 --view Plain
OCIO=$config shows 137 --exposure 0 # without --view a picture is sRGB

expect 1 "$relume" tonemap "$grey" -o "$png" --ocio "$config" --view Film
for words in '"Film"' '"Monitor" with the views "Root", "Plain"' '"Cinema screen" with the views "Halved"'; do
    contains "$err" "$words"
done
expect 1 "$relume" tonemap "$grey" -o "$png" --ocio "$config" --display Projector
contains "$err" '"Cinema screen"'
expect 1 "$relume" tonemap "$grey" -o "$png" --ocio "$config" --from acescg
contains "$err" '"lin_rec709"'
expect 1 "$relume" tonemap "$grey" -o "$png" --view Film
contains "$err" "--ocio"
expect 1 "$relume" tonemap "$grey" -o "$png" --ocio "$folder/none.ocio"
contains "$err" "none.ocio"
expect 2 "$relume" tonemap "$grey" -o "$png" --ocio "$config" --curve filmic
contains "$err" "--curve"

# A linear space of no known name: it has to be told, unless the configuration knows that of ACES.
make_config working ""
expect 1 "$relume" tonemap "$grey" -o "$png" --ocio "$config"
contains "$err" "--from"
shows 128 --ocio "$config" --from scene_linear
make_config ap0 "  aces_interchange: ap0"
shows 128 --ocio "$config" # grey stays grey from one white to another

echo "not: a configuration" >"$config"
expect 1 "$relume" tonemap "$grey" -o "$png" --ocio "$config"
contains "$err" "config.ocio"
finish
