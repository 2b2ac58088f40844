# For scripts that use the walkthrough as a person does: a display of its own, keys, and what the program says of itself
# (--state). To be sourced first; needs Xvfb and xdotool.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.." || exit 1
root=$PWD
work=$(mktemp -d)
failed=0 checks=0
pid="" server=""
finish() {
  [[ -n $pid ]] && kill "$pid" 2>/dev/null
  [[ -n $server ]] && kill "$server" 2>/dev/null
  rm -rf "$work"
}
trap finish EXIT
cd "$work" || exit 1 # recordings and screenshots go to ./out
export XDG_CONFIG_HOME=$work/config # what is kept between runs is not the person's own

Xvfb -displayfd 3 -screen 0 800x600x24 -nolisten tcp -noreset 3>display 2>/dev/null &
server=$!
for _ in {1..100}; do
  [[ -s display ]] && break
  sleep 0.1
done
DISPLAY=:$(cat display)
export DISPLAY

play() { # ARGUMENTS...
  rm -f state.json
  "$root/build/bin/walkthrough" --state state.json "$@" 2>errors &
  pid=$!
  xdotool mousemove 160 170 # keys go to the window under the pointer, and the panel is elsewhere
}

stop() { # the program that is played
  kill "$pid"
  wait "$pid" 2>/dev/null
  pid=""
}

# A Python expression over the state `s`.
state() { # EXPRESSION
  python3 - "$1" <<'PYTHON'
import json, sys
try:
    s = json.load(open("state.json"))
    print(eval(sys.argv[1]))
except Exception as e:
    print(f"no state: {e}")
PYTHON
}

# Waits until the expression holds.
await() { # WHAT SECONDS EXPRESSION
  checks=$((checks + 1))
  local end=$(($(date +%s%N) + $2 * 1000000000))
  while (($(date +%s%N) < end)); do
    [[ $(state "$3") == True ]] && return
    sleep 0.1
  done
  failed=$((failed + 1))
  echo "FAILED: $1: not within $2 s: $3; state: $(cat state.json 2>/dev/null) $(cat errors)"
}

check() { # WHAT COMMAND...
  checks=$((checks + 1))
  "${@:2}" && return
  failed=$((failed + 1))
  echo "FAILED: $1: ${*:2}; state: $(cat state.json 2>/dev/null) $(cat errors)"
}

key() { xdotool key "$1"; }
hold() { # KEY SECONDS
  xdotool keydown "$1"
  sleep "$2"
  xdotool keyup "$1"
}
ended() { # SECONDS: the program did, with exit code 0
  local end=$((SECONDS + $1))
  while kill -0 "$pid" 2>/dev/null && ((SECONDS < end)); do sleep 0.1; done
  ! kill -0 "$pid" 2>/dev/null && wait "$pid" && pid=""
}

few=(--set smc.vpls=64 --set smc.warmup=2)
