# cmake -DTREE=… "-DFILES=a.a,b,…" -P paths_test.cmake
#
# No archive or program contains a path of the build machine.

cmake_minimum_required(VERSION 3.25)
string(REGEX REPLACE "([][+.*()^$?|\\])" "\\\\\\1" pattern "${TREE}/")
string(REPLACE "," ";" files "${FILES}")
foreach(file IN LISTS files)
  file(STRINGS ${file} found REGEX "${pattern}" LIMIT_COUNT 3)
  if(found)
    message(SEND_ERROR "${file} holds: ${found}")
  endif()
endforeach()
