#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Stands in for a benchmark; counts its runs in SELFTEST_COUNT.
set -euo pipefail
echo run >>"$SELFTEST_COUNT"
echo "some talk that is no row"
echo "row fake.green value=1.5 unit=ms min=1.25 max=1.75 runs=5 hash=00ff"
echo "row fake.red value=9.5e0 unit=1/s min=9 max=10 runs=3 hash=abc"
echo "row fake.equal value=3.0 unit=-"
echo "row fake.shown value=123456789 unit=B"
echo "row fake.nan value=nan unit=s"
echo "row fake.unit value=0.5 unit=ms"
echo "row fake.greenish value=7 unit=ms"
