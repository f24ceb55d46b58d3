#!/bin/sh
# pack.sh OUT - one HTML file that needs nothing else: page.html with page.css, page.js and page.c as WebAssembly.
# clang makes it without a C library: libc.h stands for the headers. Only page.c's functions are exported.
set -eu
out=$1
folder=$(dirname "$out")
here=examples/page
for program in clang wasm-ld; do
  command -v $program > /dev/null || {
    echo "page: no $program (Debian: apt-get install clang lld)"
    exit 1
  }
done
mkdir -p "$folder/include"
for header in math string stdio stdlib time; do
  echo '#include "libc.h"' > "$folder/include/$header.h"
done
clang --target=wasm32 -std=c99 -O2 -ffreestanding -fno-math-errno -ffp-contract=off -mbulk-memory -nostdlib -D__thread= \
  -Wall -Wextra -Wno-unused-function -Wno-unused-parameter -DFLEXBEAM_STATIC -I. -isystem "$folder/include" -isystem $here -o "$folder/page.wasm" $here/page.c \
  -Wl,--no-entry -Wl,--allow-undefined -Wl,--strip-all -Wl,-z,stack-size=1048576 -Wl,--stack-first \
  $(sed -n 's/^[a-z].*[ *]\(page_[a-z_]*\)(.*);.*/-Wl,--export=\1/p' $here/page.c)
base64 "$folder/page.wasm" > "$folder/page.base64"
awk -v here=$here -v folder="$folder" '
  function put(file,  line) {
    while ((getline line < file) > 0) print line
    close(file)
  }
  /^<!-- page.css -->$/ { print "<style>"; put(here "/page.css"); print "</style>"; next }
  /^<!-- page.js -->$/ { print "<script>"; put(here "/page.js"); print "</script>"; next }
  /^<!-- page.wasm -->$/ { print "<script type=\"application/octet-stream\" id=\"wasm\">"; put(folder "/page.base64"); print "</script>"; next }
  { print }' $here/page.html > "$out"
echo "$out: $(wc -c < "$out") bytes, $(wc -c < "$folder/page.wasm") of them WebAssembly before its encoding: open it in a browser"
