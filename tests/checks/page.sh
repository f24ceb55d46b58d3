#!/bin/sh
# The page: it is made, opens from a file in a browser without a window, and there (tests/checks/page.py) shows the numbers
# of the native program in every scene, does so by keyboard, names its controls, fits 400 pixels, moves at 30 frames a second.
. tests/checks/common.sh
need clang clang
need wasm-ld lld
need python3 python3
browser=
for program in chromium-headless-shell chromium; do
  [ -n "$browser" ] || browser=$(command -v $program) || true
done
[ -n "$browser" ] || fail "needs chromium-headless-shell (apt-get install chromium-headless-shell)"
try sh examples/page/pack.sh "$out/flexbeam.html"
grep -q warning: "$out/log" && { cat "$out/log"; fail "warnings"; }
nothing=$(mktemp -d) # without clang it says what to install
for tool in sh dirname mkdir; do ln -s "$(command -v $tool)" "$nothing/$tool"; done
! PATH=$nothing sh examples/page/pack.sh "$out/none/flexbeam.html" > "$out/log" 2>&1 && grep -q 'apt-get install clang lld' "$out/log" ||
  fail "without clang: $(cat "$out/log")"
rm -r "$nothing"
python3 tests/checks/page.py "$out" "$browser" "$out/flexbeam.html" build/examples/page > "$out/log" 2>&1 || {
  cat "$out/log"
  fail "tests/checks/page.py"
}
ok "$(tail -n 1 "$out/log")"
