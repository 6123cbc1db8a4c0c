# SPDX-License-Identifier: MIT
# A translation unit with CGAL's headers takes up to 3.4 GB to compile. Every target that uses CGAL
# compiles in a Ninja pool with one job for each 4 GB of memory, whatever -j says.
include_guard()

cmake_host_system_information(RESULT souple_memory_mb QUERY TOTAL_PHYSICAL_MEMORY)
# In a container the limit of the control group is what counts.
if(EXISTS "/sys/fs/cgroup/memory.max")
  file(READ "/sys/fs/cgroup/memory.max" souple_cgroup_bytes)
  string(STRIP "${souple_cgroup_bytes}" souple_cgroup_bytes)
  if(souple_cgroup_bytes MATCHES "^[0-9]+$")
    math(EXPR souple_cgroup_mb "${souple_cgroup_bytes} / 1048576")
    if(souple_cgroup_mb GREATER 0 AND souple_cgroup_mb LESS souple_memory_mb)
      set(souple_memory_mb ${souple_cgroup_mb})
    endif()
  endif()
endif()
math(EXPR SOUPLE_HEAVY_JOBS "${souple_memory_mb} / 4096")
if(SOUPLE_HEAVY_JOBS LESS 1)
  set(SOUPLE_HEAVY_JOBS 1)
endif()
set_property(GLOBAL APPEND PROPERTY JOB_POOLS souple_heavy=${SOUPLE_HEAVY_JOBS})

function(souple_limit_heavy_jobs folder)
  get_property(targets DIRECTORY "${folder}" PROPERTY BUILDSYSTEM_TARGETS)
  foreach(target IN LISTS targets)
    get_target_property(links ${target} LINK_LIBRARIES)
    if(links MATCHES "CGAL::")
      set_target_properties(${target} PROPERTIES JOB_POOL_COMPILE souple_heavy)
    endif()
  endforeach()
  get_property(subfolders DIRECTORY "${folder}" PROPERTY SUBDIRECTORIES)
  foreach(subfolder IN LISTS subfolders)
    souple_limit_heavy_jobs("${subfolder}")
  endforeach()
endfunction()

souple_limit_heavy_jobs("${PROJECT_SOURCE_DIR}")
