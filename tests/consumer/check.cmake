# Installs the build in trilobe_build_dir into scratch_dir, then configures, builds and runs the
# project beside this script against what was installed, and nothing else of this repository.
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
  -DCMAKE_FIND_USE_PACKAGE_REGISTRY=OFF)
run(${CMAKE_COMMAND} --build ${build_dir})
run(${build_dir}/consumer)

find_program(trilobe_program trilobe PATHS ${prefix}/bin NO_DEFAULT_PATH)
if(trilobe_program)
  run(${trilobe_program} help)
endif()
