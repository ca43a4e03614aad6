# Where pip builds a package in a checkout in which ./run or ./check has built the library by the same compiler with
# the same flags, TRILOBE_BUILT is the folder of that build, which this brings up to date: the package takes the
# library and the program from there. Elsewhere TRILOBE_BUILT is empty, and all is compiled.
set(TRILOBE_BUILT)
set(built ${PROJECT_SOURCE_DIR}/build/release)
if(NOT SKBUILD OR NOT EXISTS ${built}/bin/trilobe)
  return()
endif()
find_program(TRILOBE_FLOCK flock)
if(NOT TRILOBE_FLOCK)
  return()
endif()

set(same CMAKE_HOME_DIRECTORY CMAKE_CXX_FLAGS CMAKE_CXX_FLAGS_RELEASE CMAKE_EXE_LINKER_FLAGS CMAKE_BUILD_TYPE
    CMAKE_UNITY_BUILD BUILD_SHARED_LIBS TRILOBE_WIDEST_VECTOR)
load_cache(${built} READ_WITH_PREFIX built_ CMAKE_CXX_COMPILER ${same})
# A compiler has several names: pip's is that which Python was compiled by.
file(REAL_PATH "${CMAKE_CXX_COMPILER}" compiler)
file(REAL_PATH "${built_CMAKE_CXX_COMPILER}" built_compiler)
# What it was when that build was configured.
set(compiler_version ${CMAKE_CXX_COMPILER_VERSION})
file(GLOB properties ${built}/CMakeFiles/*/CMakeCXXCompiler.cmake)
set(built_compiler_version)
if(properties)
  file(STRINGS ${properties} line REGEX "^set\\(CMAKE_CXX_COMPILER_VERSION ")
  string(REGEX REPLACE ".*\"(.*)\".*" "\\1" built_compiler_version "${line}")
endif()
foreach(variable IN LISTS same ITEMS compiler compiler_version)
  if(NOT "${${variable}}" STREQUAL "${built_${variable}}")
    message(STATUS "Not with the library of ${built}: ${variable} is '${built_${variable}}' there, not '${${variable}}'")
    return()
  endif()
endforeach()

# One at a time, as in scripts/setup.sh.
set(targets trilobe_evaluate)
if(TRILOBE_BUILD_LIBRARY)
  list(APPEND targets trilobe_app)
endif()
message(STATUS "Bringing the library of ${built} up to date")
execute_process(COMMAND ${TRILOBE_FLOCK} ${PROJECT_SOURCE_DIR}/build/setup.lock
                        ${CMAKE_COMMAND} --build ${built} --target ${targets}
                RESULT_VARIABLE status)
if(status EQUAL 0)
  set(TRILOBE_BUILT ${built})
else()
  message(STATUS "Not with the library of ${built}, which cannot be brought up to date")
endif()
