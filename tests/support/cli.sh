# For scripts that use the program as a person does: [--long] [LAMBENT] (default build/bin/lambent), a folder for what it
# writes, and what has passed. To be sourced in the root of the repository.
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
# Figures of `lambent stability` with "${common[@]}" keep within tests/cli/limits; shows them.
stability() { # LIMITS NAME ARGUMENTS...
  local limits=$1 name=$2
  shift 2
  "$lambent" stability "$@" "${common[@]}" --out "$work/$name" --json "$work/$name.json" &&
    tests/cli/limits "$limits" "$work/$name.json" || failed=1
  cat "$work/$name/stability.md"
}
