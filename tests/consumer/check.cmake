# Installs the build in trilobe_build_dir into scratch_dir, then configures, builds and runs the
# project beside this script, with the code of docs/ceres.md in code_dir, against what was installed,
# and nothing else of this repository.
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(prefix ${scratch_dir}/prefix)
set(build_dir ${scratch_dir}/build)
file(REMOVE_RECURSE ${scratch_dir})

run(${CMAKE_COMMAND} --install ${trilobe_build_dir} --config ${config} --prefix ${prefix})
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${build_dir} -G ${generator}
  -DCMAKE_BUILD_TYPE=${config}
  -DCMAKE_CXX_COMPILER=${cxx_compiler}
  -DCMAKE_CXX_FLAGS=${cxx_flags}
  -DCMAKE_PREFIX_PATH=${prefix}
  -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF
  -Dcode_dir=${code_dir})
run(${CMAKE_COMMAND} --build ${build_dir})
run(${build_dir}/consumer WORKING_DIRECTORY ${scratch_dir})
run(${build_dir}/fit_copper)

# It has made the program's own model.
find_program(trilobe_program trilobe PATHS ${prefix}/bin NO_DEFAULT_PATH)
if(trilobe_program)
  if(NOT EXISTS ${prefix}/share/man/man1/trilobe.1)
    message(FATAL_ERROR "the program is installed without its manual")
  endif()
  run(${trilobe_program} fit synth:plastic --noise=0.02 --noplots --out=${scratch_dir}/fit)
  file(READ ${scratch_dir}/plastic.json ours)
  file(READ ${scratch_dir}/fit/model.json theirs)
  foreach(key d s D F G)
    string(JSON our_table GET "${ours}" ${key})
    string(JSON their_table GET "${theirs}" ${key})
    if(NOT our_table STREQUAL their_table)
      message(FATAL_ERROR "${key} of the consumer's model is not that of `trilobe fit`")
    endif()
  endforeach()
endif()
