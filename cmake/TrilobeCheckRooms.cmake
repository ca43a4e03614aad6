# cmake -Dsource_dir=SRC -P TrilobeCheckRooms.cmake: checks which headers the files of SRC include.
# - A file includes headers of its own room, and of those that SRC/rooms.txt lists for it.
# - Each of these is needed by some file, and comes before it in the list, so that no room depends,
#   however indirectly, on itself.
# - NAME.cc includes its own NAME.h first, so that a build without precompiled headers proves NAME.h
#   to compile by itself.
# - Headers of the library include no other project's, which its users would have to have.
# - Headers that SRC/public.txt lists, which are installed, include no others.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/TrilobeRooms.cmake)
trilobe_read_rooms(${source_dir}/rooms.txt)

set(errors "")
set(lower)
foreach(room IN LISTS rooms)
  foreach(other IN LISTS ${room}_sees)
    if(NOT other IN_LIST lower)
      string(APPEND errors "rooms.txt: ${room} sees ${other}, which is not listed above it\n")
    endif()
  endforeach()
  list(APPEND lower ${room})
  set(used)
  file(GLOB files ${source_dir}/${room}/*.h ${source_dir}/${room}/*.cc)
  foreach(file IN LISTS files)
    string(REPLACE ${source_dir}/ "" name ${file})
    file(STRINGS ${file} includes REGEX "^#include [<\"]")
    foreach(include IN LISTS includes)
      if(include MATCHES "^#include \"(.*/)?([^/]*)\"")
        set(path "${CMAKE_MATCH_1}")
        if(NOT path MATCHES "^trilobe/([a-z/]+)/$")
          string(APPEND errors "${name}: write ${include} as \"trilobe/ROOM/NAME.h\"\n")
          continue()
        endif()
        set(other ${CMAKE_MATCH_1})
        list(APPEND used ${other})
        if(NOT other STREQUAL room AND NOT other IN_LIST ${room}_sees)
          string(APPEND errors "${name}: ${include}, but the room ${room} does not see ${other}; "
                               "rooms.txt says what it sees\n")
        endif()
      elseif(file MATCHES "\\.h$" AND NOT room STREQUAL "app" AND include MATCHES "<.*[/.].*>")
        string(APPEND errors "${name}: ${include} in a header of the library, whose users would need "
                             "it; include it in a .cc file\n")
      endif()
    endforeach()
    string(REGEX REPLACE "\\.cc$" ".h" own ${name})
    if(NOT own STREQUAL name AND EXISTS ${source_dir}/${own}
       AND NOT includes MATCHES "^#include \"trilobe/${own}\"")
      string(APPEND errors "${name}: include trilobe/${own} first\n")
    endif()
  endforeach()
  foreach(other IN LISTS ${room}_sees)
    if(NOT other IN_LIST used)
      string(APPEND errors "rooms.txt: no file of ${room} includes a header of ${other}; "
                           "take it from the list\n")
    endif()
  endforeach()
endforeach()

file(STRINGS ${source_dir}/public.txt public REGEX "^[^#]")
foreach(unit IN LISTS public)
  if(NOT EXISTS ${source_dir}/${unit}.h)
    string(APPEND errors "public.txt: there is no ${unit}.h\n")
    continue()
  endif()
  file(STRINGS ${source_dir}/${unit}.h includes REGEX "^#include \"trilobe/")
  foreach(include IN LISTS includes)
    string(REGEX REPLACE "^#include \"trilobe/(.*)\\.h\"" "\\1" other "${include}")
    if(NOT other IN_LIST public)
      string(APPEND errors "${unit}.h: ${include} in a public header; public.txt does not list it\n")
    endif()
  endforeach()
endforeach()

file(GLOB_RECURSE all RELATIVE ${source_dir} ${source_dir}/*.h ${source_dir}/*.cc)
foreach(name IN LISTS all)
  get_filename_component(room ${name} DIRECTORY)
  if(NOT room IN_LIST rooms)
    string(APPEND errors "${name}: rooms.txt does not list the room ${room}\n")
  endif()
endforeach()

if(errors)
  string(REGEX REPLACE "\n(.)" "\n  \\1" errors "${errors}")  # indented, so that no line is wrapped
  message(FATAL_ERROR "  ${errors}")
endif()
