#!/usr/bin/env bash
# check_install.sh BUILD_FOLDER WORK_FOLDER CMAKE CXX: installs, moves the tree, builds and runs the consumer twice.
set -euo pipefail
build=$1 work=$2 cmake=$3 cxx=$4
source_dir=$(cd "$(dirname "$0")" && pwd)

rm -rf "$work/first" "$work/moved" "$work/consumer"
mkdir -p "$work"
"$cmake" --install "$build" --prefix "$work/first" > "$work/install.log"
mv "$work/first" "$work/moved"  # nothing may remember where it was installed

"$work/moved/bin/knotreel" --version
grep -q '^\.TH KNOTREEL 1' "$work/moved/share/man/man1/knotreel.1"
grep -q '^complete ' "$work/moved/share/bash-completion/completions/knotreel"

printf 'P2 8 4 255 %s' "$(seq -s ' ' 0 8 255)" > "$work/ramp.pgm"
"$work/moved/bin/knotreel" vectorize "$work/ramp.pgm" -o "$work/ramp.tcb"

"$cmake" -S "$source_dir/consumer" -B "$work/consumer" -G Ninja -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_CXX_COMPILER="$cxx" -DCMAKE_PREFIX_PATH="$work/moved"
"$cmake" --build "$work/consumer"
"$work/consumer/consumer"
"$work/consumer/draw" "$work/ramp.tcb"

PKG_CONFIG_PATH=$(dirname "$(find "$work/moved" -name knotreel.pc)")
export PKG_CONFIG_PATH
# pkg-config escapes the spaces of paths for a shell.
eval "flags=($(pkg-config --cflags --libs knotreel))"
for program in main draw; do
  "$cxx" -std=c++20 -o "$work/by-pkg-config" "$source_dir/consumer/$program.cpp" "${flags[@]}"
  "$work/by-pkg-config" "$work/ramp.tcb"
done
