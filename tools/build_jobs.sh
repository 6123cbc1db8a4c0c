#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Prints how many jobs a build may run here: one for each processor, and at least 1.5 GB of memory for
# each (translation units with Eigen take about 1 GB; those with CGAL have a pool of their own, see
# cmake/SoupleJobPools.cmake). SOUPLE_JOBS overrides it.
set -euo pipefail

memory_kib=$(awk '$1 == "MemTotal:" {print $2}' /proc/meminfo)
# In a container the limit of the control group is what counts.
for limit_file in /sys/fs/cgroup/memory.max /sys/fs/cgroup/memory/memory.limit_in_bytes; do
  if [ -r "$limit_file" ]; then
    limit=$(cat "$limit_file")
    if [[ "$limit" =~ ^[0-9]{1,15}$ ]] && [ $((limit / 1024)) -lt "$memory_kib" ]; then
      memory_kib=$((limit / 1024))
    fi
  fi
done

jobs=$(nproc)
by_memory=$((memory_kib / 1572864))
if [ "$by_memory" -lt "$jobs" ]; then jobs=$by_memory; fi
if [ "$jobs" -lt 1 ]; then jobs=1; fi
echo "${SOUPLE_JOBS:-$jobs}"
