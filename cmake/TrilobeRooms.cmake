# trilobe_read_rooms(FILE): sets `rooms` to the rooms that FILE (src/rooms.txt) lists, and
# `ROOM_sees` to those whose headers the files of ROOM include.
macro(trilobe_read_rooms file)
  file(STRINGS ${file} room_lines REGEX "^[a-z]")
  set(rooms)
  foreach(room_line IN LISTS room_lines)
    string(REGEX MATCH "^([a-z/]+):(.*)$" room_line "${room_line}")
    list(APPEND rooms ${CMAKE_MATCH_1})
    string(REGEX MATCHALL "[a-z/]+" ${CMAKE_MATCH_1}_sees "${CMAKE_MATCH_2}")
  endforeach()
endmacro()
