# run(OUTPUT command…): the command's standard output in OUTPUT. If it fails, the test fails with its whole output.
function(run output)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE said ERROR_VARIABLE complained RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    string(REPLACE ";" " " command "${ARGN}")
    message(NOTICE "${said}${complained}")
    message(FATAL_ERROR "exit status ${status} of: ${command}")
  endif()
  set(${output} "${said}" PARENT_SCOPE)
endfunction()

# expect(TEXT REGEX SENTENCE): the test fails with the sentence unless the text matches.
function(expect text regex sentence)
  if(NOT text MATCHES "${regex}")
    message(NOTICE "${text}")
    message(FATAL_ERROR "${sentence}; expected to find above: ${regex}")
  endif()
endfunction()
