# souple_target(NAME): the settings that every target of the project shares. All PRIVATE: nothing leaks
# to those who link it but the include folder and the language level.
include_guard()

if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG")
set(CMAKE_C_FLAGS_RELEASE "-O3 -DNDEBUG")
set(SOUPLE_MARCH "x86-64-v3" CACHE STRING "Baseline instruction set (-march)")
set(CMAKE_POSITION_INDEPENDENT_CODE ON)

function(souple_target name)
  target_compile_features(${name} PUBLIC cxx_std_20)
  set_target_properties(${name} PROPERTIES CXX_EXTENSIONS OFF)
  target_include_directories(${name} PUBLIC
    "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>"
    "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/souple>")
  # -ffp-contract=off: the same source gives the same bits whatever the compiler fuses; products that
  # want FMA ask for it by intrinsics.
  target_compile_options(${name} PRIVATE -march=${SOUPLE_MARCH} -ffp-contract=off)
  # -Wno-restrict: GCC 12 warns falsely inside std::string (GCC bug 105651).
  target_compile_options(${name} PRIVATE -Wall -Wextra -Wshadow -Wnon-virtual-dtor
    $<$<COMPILE_LANGUAGE:CXX>:-Woverloaded-virtual> -Wno-psabi -Wno-restrict)
  if(SOUPLE_WARNINGS_AS_ERRORS)
    target_compile_options(${name} PRIVATE -Werror)
  endif()
endfunction()
