#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# System calls that a haptic tick makes: the program that only ticks, traced with few and with many
# ticks; the difference belongs to the ticks. Usage: tick_syscalls.sh PROGRAM
set -eu
program=$1
few=10
many=2010
if ! command -v strace > /dev/null; then
  echo "skipped: there is no strace here" >&2
  exit 0
fi
trace=$(mktemp)
trap 'rm -f "$trace"' EXIT

# Calls in total, of all threads.
count() {
  strace -f -c -o "$trace" "$program" ticks "$1"
  awk '$NF == "total" { print $(NF - 1) ~ /^[0-9]+$/ && NF > 5 ? $(NF - 2) : $(NF - 1) }' "$trace"
}

with_few=$(count "$few")
with_many=$(count "$many")
echo "row haptics.syscalls value=$(((with_many - with_few) > 0 ? with_many - with_few : 0)) unit=1"
