# cmake -DBUILD=… -DCONFIG=… -DLIBRARY=… -DNM=… -P exports_test.cmake
#
# Builds the shared library and compares its exported symbols of weft with exported_symbols.txt beside this file. Every
# difference is a change of the public interface: note it in CHANGELOG.md, and update the list.

cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

run(output ${CMAKE_COMMAND} --build ${BUILD} --target weft_shared --config ${CONFIG} --parallel 2)
run(output ${NM} -D --defined-only -C ${LIBRARY})
string(REGEX MATCHALL "[^\n]+" lines "${output}")
set(symbols "")
foreach(line IN LISTS lines)
  string(REGEX REPLACE "^[0-9a-f]+ . " "" symbol "${line}")
  if(symbol MATCHES "(^| )weft::")
    list(APPEND symbols "${symbol}")
  endif()
endforeach()
list(REMOVE_DUPLICATES symbols)
list(SORT symbols)
list(JOIN symbols "\n" exported)
file(READ ${CMAKE_CURRENT_LIST_DIR}/exported_symbols.txt listed)
string(STRIP "${listed}" listed)
if(NOT exported STREQUAL listed)
  file(WRITE ${BUILD}/exported_symbols.txt "${exported}\n")
  message(FATAL_ERROR "exported symbols differ from exported_symbols.txt; what is exported: ${BUILD}/exported_symbols.txt")
endif()
