# Copies what is needed to build trilobe::evaluate from source_dir into scratch_dir, and checks that
# the build of it fails once a file breaks a rule of cmake/TrilobeCheckRooms.cmake.
file(REMOVE_RECURSE ${scratch_dir})
file(COPY ${source_dir}/CMakeLists.txt ${source_dir}/cmake ${source_dir}/src ${source_dir}/include
     DESTINATION ${scratch_dir})
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${scratch_dir} -B ${scratch_dir}/build -G ${generator}
          -DCMAKE_CXX_COMPILER=${cxx_compiler} -DTRILOBE_BUILD_LIBRARY=OFF -DTRILOBE_INSTALL=OFF
  COMMAND_ERROR_IS_FATAL ANY)
set(build ${CMAKE_COMMAND} --build ${scratch_dir}/build --target trilobe_check_rooms)
execute_process(COMMAND ${build} COMMAND_ERROR_IS_FATAL ANY)
# A file written within one tick of the file system's clock does not count as newer.
execute_process(COMMAND ${CMAKE_COMMAND} -E sleep 1)

# expect_failure(FILE TEXT MESSAGE): with TEXT before what FILE, of src or include/trilobe, holds, the
# build of the library fails, and says MESSAGE.
function(expect_failure file text message)
  set(path ${scratch_dir}/src/${file})
  if(NOT EXISTS ${path})
    set(path ${scratch_dir}/include/trilobe/${file})
  endif()
  file(READ ${path} before)
  file(WRITE ${path} "${text}\n${before}")
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${scratch_dir}/build --target trilobe_evaluate
                  RESULT_VARIABLE status OUTPUT_VARIABLE out ERROR_VARIABLE out)
  file(WRITE ${path} "${before}")
  string(FIND "${out}" "${message}" at)
  if(status EQUAL 0 OR at EQUAL -1)
    message(FATAL_ERROR "${text} in ${file} gave status ${status}, without '${message}':\n${out}")
  endif()
endfunction()

expect_failure(core/base/stencil.h "#include \"trilobe/core/system/parallel.h\""
               "core/base/stencil.h: #include \"trilobe/core/system/parallel.h\", but the room base does not see system")
# A folder that sorts the files of a room is part of it.
expect_failure(io/formats/text/csv_file.cc "#include \"fit/held_out.h\""
               "io/formats/text/csv_file.cc: #include \"fit/held_out.h\", but the room formats does not see fit")
expect_failure(solvers/solver.cc "#include \"../files/file.h\""
               "solvers/solver.cc: write #include \"../files/file.h\" as \"trilobe/GROUP/ROOM/NAME.h\" or")
expect_failure(solvers/solver.cc "#include \"solvers/solver.h\""
               "solvers/solver.cc: there is no header for #include \"solvers/solver.h\"")
expect_failure(model/objective/reconstruct.h "#include <Eigen/Core>"
               "model/objective/reconstruct.h: #include <Eigen/Core> in a public header")
expect_failure(core/base/stencil.cc "#include <cmath>"
               "core/base/stencil.cc: include trilobe/core/base/stencil.h first")
expect_failure(rooms.txt "== extra:\nextra: model" "rooms.txt: extra sees model, which is not listed above it")
expect_failure(rooms.txt "== attic:\nextra:\nother: extra"
               "rooms.txt: no file of other includes a header of extra")
expect_failure(rooms.txt "== attic: model" "rooms.txt: attic sees model, which is not listed above it")
expect_failure(solvers/sums/normal_equations.h "#include \"solvers/sums/parameter_kind.h\""
               "solvers/sums/normal_equations.h: #include \"solvers/sums/parameter_kind.h\" in a public header")
expect_failure(solvers/sums/parameter_kind.h "#include \"solvers/sums/accumulators.h\""
               "sums: accumulators, add_normal_equations, ")
# The lists of registries count, too.
expect_failure(solvers/solver.cc "#define TRILOBE_DECLARE(NAME) SolverEntry NAME##Entry();\n//  X(Auto)"
               "solvers/solver.cc: AutoEntry(), but the room solvers does not see starts")
# docs/adding-a-solver.md keeps to them as it is typed.
file(READ ${source_dir}/docs/adding-a-solver.md page)
string(FIND "${page}" "```cpp\n" begin)
math(EXPR begin "${begin} + 7")
string(SUBSTRING "${page}" ${begin} -1 code)
string(FIND "${code}" "```\n" end)
string(SUBSTRING "${code}" 0 ${end} code)
file(WRITE ${scratch_dir}/src/solvers/compass_search.cc "${code}")
execute_process(COMMAND ${build} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} -E sleep 1)
# "A solver sees no file": a room may not see another group's unless its own group does.
file(READ ${scratch_dir}/src/rooms.txt rooms)
string(REPLACE "== io: core model" "== io: core" without "${rooms}")
file(WRITE ${scratch_dir}/src/rooms.txt "${without}")
execute_process(COMMAND ${build} RESULT_VARIABLE status ERROR_VARIABLE out OUTPUT_VARIABLE out)
string(FIND "${out}" "rooms.txt: formats sees model, but the group io does not see model" at)
if(status EQUAL 0 OR at EQUAL -1)
  message(FATAL_ERROR "a group that does not see another gave status ${status}:\n${out}")
endif()
file(WRITE ${scratch_dir}/src/rooms.txt "${rooms}")
execute_process(COMMAND ${build} COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} -E sleep 1)
file(MAKE_DIRECTORY ${scratch_dir}/src/attic)
file(WRITE ${scratch_dir}/src/attic/old.h "")
execute_process(COMMAND ${build} RESULT_VARIABLE status ERROR_VARIABLE out OUTPUT_VARIABLE out)
string(FIND "${out}" "attic/old.h: rooms.txt does not list the room attic" at)
if(status EQUAL 0 OR at EQUAL -1)
  message(FATAL_ERROR "a folder that rooms.txt does not list gave status ${status}:\n${out}")
endif()
