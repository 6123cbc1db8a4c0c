# SPDX-License-Identifier: MIT
# Installs the libraries that applications link, their headers, the HDF5 filter plugin and the command,
# and the package files behind find_package(souple COMPONENTS runtime | runtime_load | …).
#
# Every component has an export set of its own, so that who asks for `runtime` needs no HDF5:
#   runtime  formats_core, runtime, devices        needs Eigen
#   load     formats_read, runtime_load            needs HDF5 and zstd at the link
#   write    formats_write                         needs HDF5 and zstd at the link
#   c        c, the C interface, shared            needs nothing: it brings the runtime
#   c_static c_static, the same as a static one    stands on load
#   tools    the souple command
include_guard()
include(CMakePackageConfigHelpers)
include(SoupleOwnLinks)

set(SOUPLE_PACKAGE_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/souple")
set(souple_exported_targets "")
set(souple_external_links "")

# souple_export(SET TARGETS…): installs the targets that exist, and those of ours that they link and no
# earlier set holds.
macro(souple_export set_name)
  set(souple_set_targets "")
  foreach(target IN ITEMS ${ARGN})
    if(TARGET ${target})
      souple_own_links(${target} souple_closure souple_closure_externals)
      list(APPEND souple_set_targets ${souple_closure})
      list(APPEND souple_external_links ${souple_closure_externals})
    endif()
  endforeach()
  list(REMOVE_DUPLICATES souple_set_targets)
  list(REMOVE_ITEM souple_set_targets ${souple_exported_targets} "")
  if(souple_set_targets)
    foreach(target IN LISTS souple_set_targets)
      string(REGEX REPLACE "^souple_" "" souple_export_name ${target})
      set_target_properties(${target} PROPERTIES EXPORT_NAME ${souple_export_name})
    endforeach()
    install(TARGETS ${souple_set_targets} EXPORT souple_${set_name}
      ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT ${set_name}
      LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT ${set_name}
      RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT ${set_name})
    install(EXPORT souple_${set_name} FILE souple_${set_name}.cmake NAMESPACE souple::
      DESTINATION "${SOUPLE_PACKAGE_DIR}" COMPONENT ${set_name})
    list(APPEND souple_exported_targets ${souple_set_targets})
  endif()
endmacro()

souple_export(runtime souple_formats_core souple_runtime souple_devices)
souple_export(load souple_formats_read souple_runtime_load)
souple_export(write souple_formats_write)
souple_export(c souple_c)
souple_export(c_static souple_c_static)

# soupleConfig.cmake knows how to find these again, and no others: an application that links us must not
# meet a package that nobody told it of.
list(REMOVE_DUPLICATES souple_external_links)
foreach(external IN LISTS souple_external_links)
  if(external MATCHES "::" AND NOT external MATCHES
     "^(Eigen3::Eigen|hdf5::hdf5|zstd::libzstd_shared|zstd::libzstd|Threads::Threads)$")
    message(FATAL_ERROR "an installed target links ${external}; add it to soupleConfig.cmake.in")
  endif()
endforeach()

# The command is an export set of its own without the libraries behind it: those stay inside.
if(TARGET souple)
  install(TARGETS souple EXPORT souple_tools
    RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT tools)
  install(EXPORT souple_tools FILE souple_tools.cmake NAMESPACE souple::
    DESTINATION "${SOUPLE_PACKAGE_DIR}" COMPONENT tools)
endif()

# The zstd filter for other HDF5 programs: HDF5_PLUGIN_PATH=<prefix>/lib/souple/hdf5-plugins.
get_property(souple_formats_targets DIRECTORY "${PROJECT_SOURCE_DIR}/formats"
  PROPERTY BUILDSYSTEM_TARGETS)
foreach(target IN LISTS souple_formats_targets)
  get_target_property(souple_target_type ${target} TYPE)
  if(souple_target_type STREQUAL "MODULE_LIBRARY")
    install(TARGETS ${target} LIBRARY
      DESTINATION "${CMAKE_INSTALL_LIBDIR}/souple/hdf5-plugins" COMPONENT load)
  endif()
endforeach()

# Headers keep their place in the tree below include/souple. What a component cannot link is left out.
function(souple_install_headers component)
  foreach(folder IN ITEMS ${ARGN})
    get_filename_component(parent "${folder}" DIRECTORY)
    install(DIRECTORY "${PROJECT_SOURCE_DIR}/${folder}"
      DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/souple/${parent}" COMPONENT ${component}
      FILES_MATCHING PATTERN "*.hpp" PATTERN "*.def"
      PATTERN "load" EXCLUDE PATTERN "internal" EXCLUDE)
  endforeach()
endfunction()
souple_install_headers(runtime formats/core runtime)
if(SOUPLE_BUILD_LOAD)
  souple_install_headers(load formats/read)
  souple_install_headers(write formats/write)
  install(FILES runtime/load/load_soft_body.hpp
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/souple/runtime/load" COMPONENT load)
  install(FILES runtime/c_api/souple/souple.h
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/souple" COMPONENT c)
endif()

configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/soupleConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/soupleConfig.cmake" INSTALL_DESTINATION "${SOUPLE_PACKAGE_DIR}")
write_basic_package_version_file("${PROJECT_BINARY_DIR}/soupleConfigVersion.cmake"
  COMPATIBILITY SameMajorVersion)
install(FILES "${PROJECT_BINARY_DIR}/soupleConfig.cmake" "${PROJECT_BINARY_DIR}/soupleConfigVersion.cmake"
  DESTINATION "${SOUPLE_PACKAGE_DIR}" COMPONENT runtime)

install(FILES LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT runtime)
install(FILES runtime/LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}" RENAME LICENSE.MIT COMPONENT runtime)
if(TARGET souple)
  install(FILES tools/LICENSE DESTINATION "${CMAKE_INSTALL_DOCDIR}" RENAME LICENSE.GPL-3 COMPONENT tools)
endif()
