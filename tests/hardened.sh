#!/usr/bin/env bash
# Every program named is hardened: position independent, symbols bound before it starts, stack protected and not executable,
# library calls fortified.   usage: hardened.sh PROGRAM...
set -euo pipefail
failed=0
for program in "$@"; do
    fault() { echo "$program: $1"; failed=1; }
    readelf --file-header --wide "$program" | grep -q 'Type: *DYN' || fault "is not position independent"
    readelf --dynamic --wide "$program" | grep -qE 'BIND_NOW|FLAGS.*NOW' || fault "binds symbols late (no -z now)"
    readelf --program-headers --wide "$program" | grep -q GNU_RELRO || fault "has no read-only relocations"
    readelf --program-headers --wide "$program" | grep GNU_STACK | grep -q 'RWE' && fault "has an executable stack"
    symbols=$(readelf --symbols --wide "$program")
    grep -q '__stack_chk_fail' <<<"$symbols" || fault "is built without stack protection"
    grep -qE '__[a-z]+_chk' <<<"$(grep -v __stack_chk_fail <<<"$symbols")" || fault "is built without _FORTIFY_SOURCE"
done
exit $failed
