# For scripts that use the program as a person does: [--long] [LAMBENT] (default build/bin/lambent), a folder for what it
# writes, and what has passed. To be sourced first: it goes to the root of the repository.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 1
long=
[[ ${1:-} == --long ]] && long=1 && shift
lambent=$(realpath "${1:-build/bin/lambent}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
passed=0 failed=0

result() { # NAME STATUS [WHY]
  if [[ $2 == 0 ]]; then
    passed=$((passed + 1))
  else
    failed=$((failed + 1))
    echo "FAILED: $1: ${3:-}"
  fi
}
# The script's last command: how many passed, and the exit code.
summary() { # [NAME]
  echo "${1:-${0##*/}}: $passed passed, $failed failed"
  ((failed == 0))
}
fail() { # WHAT...
  echo "${0##*/}: $*" >&2
  failed=1
}
appears() { # FILE, within seconds
  for _ in {1..500}; do
    [[ -s $1 ]] && return
    sleep 0.02
  done
  return 1
}
# An ffmpeg that only tells how it was asked, in $work/asked, and writes something.
stand_in_for_ffmpeg() {
  mkdir -p "$work/bin"
  printf '#!/bin/sh\nprintf "%%s\\n" "$@" >"%s/asked"\nfor last; do :; done\necho video >"$last"\n' "$work" >"$work/bin/ffmpeg"
  chmod +x "$work/bin/ffmpeg"
}
agrees() { # NAME SCRIPT: a Python script that fails where files in $work are wrong
  (cd "$work" && python3 -c "$2") >"$work/stdout" 2>&1
  result "$1" $? "$(tail -n 3 "$work/stdout")"
}
# Figures of `lambent stability` with "${common[@]}" keep within tests/cli/limits; shows them.
stability() { # LIMITS NAME ARGUMENTS...
  local limits=$1 name=$2
  shift 2
  "$lambent" stability "$@" "${common[@]}" --out "$work/$name" --json "$work/$name.json" &&
    tests/cli/limits "$limits" "$work/$name.json" || failed=1
  cat "$work/$name/stability.md"
}
