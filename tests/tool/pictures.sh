# SPDX-License-Identifier: Apache-2.0
# For tests of the program's picture tools (sourced): a temporary folder, pictures, assertions.
# shellcheck shell=bash

folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0

# make_pfm FILE WIDTH HEIGHT HEX: a picture whose every value is the float of these 8 hex digits.
make_pfm() {
    local h=$4 value i
    value="\\x${h:6:2}\\x${h:4:2}\\x${h:2:2}\\x${h:0:2}"
    printf 'PF\n%d %d\n-1.0\n' "$2" "$3" >"$1"
    for ((i = 0; i < 3 * $2 * $3; i++)); do
        # shellcheck disable=SC2059 # the value is an escape sequence
        printf "$value"
    done >>"$1"
}

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}

# expect CODE COMMAND...: runs it, output in $out and messages in $err, and checks its exit code.
expect() {
    local code=$1 got=0
    shift
    out=$("$@" 2>"$folder/err") || got=$?
    err=$(cat "$folder/err")
    [ "$got" -eq "$code" ] || fail "exit code $got, expected $code: $*: $err"
}

# contains TEXT WORDS
contains() {
    [[ $1 == *"$2"* ]] || fail "no '$2' in: ${1:0:2000}"
}

# near JSON KEYS VALUE: the number under dotted KEYS is within 1e-5 of VALUE.
near() {
    python3 - "$@" <<'END' || fail "$2 is not $3"
import json, sys
value = json.loads(sys.argv[1])
for key in sys.argv[2].split("."):
    value = value[int(key)] if isinstance(value, list) else value[key]
ok = value is not None and abs(value - float(sys.argv[3])) <= 1e-5 * max(1, abs(float(sys.argv[3])))
print(sys.argv[2], value)
sys.exit(0 if ok else 1)
END
}

finish() {
    [ "$failures" -eq 0 ] || { echo "$failures failures"; exit 1; }
    exit 0
}
