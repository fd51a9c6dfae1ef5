#!/usr/bin/env bash
# Every program named is hardened: position independent, symbols bound before it starts, stack protected and not executable,
# library calls fortified.   usage: hardened.sh PROGRAM...
set -euo pipefail
failed=0
for program in "$@"; do
    fault() { echo "$program: $1"; failed=1; }
    grep -q 'Type: *DYN' <<<"$(readelf --file-header --wide "$program")" || fault "is not position independent"
    grep -qE 'BIND_NOW|FLAGS.*NOW' <<<"$(readelf --dynamic --wide "$program")" || fault "binds symbols late (no -z now)"
    grep -q GNU_RELRO <<<"$(readelf --program-headers --wide "$program")" || fault "has no read-only relocations"
    grep -qE 'GNU_STACK.*RWE' <<<"$(readelf --program-headers --wide "$program")" && fault "has an executable stack"
    symbols=$(readelf --symbols --wide "$program")
    grep -q '__stack_chk_fail' <<<"$symbols" || fault "is built without stack protection"
    grep -qE '__[a-z]+_chk' <<<"$(grep -v __stack_chk_fail <<<"$symbols")" || fault "is built without _FORTIFY_SOURCE"
done
exit $failed
