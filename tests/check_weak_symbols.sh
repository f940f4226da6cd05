#!/usr/bin/env bash
# No object compiled with ISA flags may define a weak symbol: the linker could keep its copy for processors without the ISA.
# Usage: check_weak_symbols.sh NM BUILD_DIR
set -euo pipefail
status=0 n=0
while IFS= read -r object; do
  n=$((n + 1))
  weak=$("$1" --defined-only "$object" | grep -E ' [WVuw] ' || true)
  if [ -n "$weak" ]; then
    printf '%s defines weak symbols:\n%s\n' "$object" "$weak"
    status=1
  fi
done < <(find "$2" -path '*pac_*' \( -name '*_sse41.cpp.o' -o -name '*_avx2.cpp.o' -o -name '*_neon.cpp.o' \))
echo "$n objects with ISA flags checked"
exit $status
