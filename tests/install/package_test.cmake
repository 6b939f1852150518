# cmake -DBUILD=… -DCONFIG=… -DTREE=… -DWORK=… -DGENERATOR=… -DCXX=… -P package_test.cmake
#
# Installs the build folder BUILD, moves the installed files, and uses them in the new folder: the program with its
# scenes, and the library from a project that uses only the package. TREE is the source tree, WORK a folder for the
# results.

cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

file(REMOVE_RECURSE ${WORK})
run(output ${CMAKE_COMMAND} --install ${BUILD} --config ${CONFIG} --prefix ${WORK}/installed)
set(prefix ${WORK}/moved)
file(RENAME ${WORK}/installed ${prefix})

# The package contains no path of the build or source folder.
file(GLOB_RECURSE package_files ${prefix}/*.cmake)
expect("${package_files}" "weft-config.cmake" "the package is not installed")
foreach(file IN LISTS package_files)
  file(READ ${file} text)
  foreach(place IN ITEMS ${TREE} ${BUILD} ${WORK}/installed)
    string(FIND "${text}" "${place}" found)
    if(NOT found EQUAL -1)
      message(FATAL_ERROR "${file} names ${place}")
    endif()
  endforeach()
endforeach()

# The program finds the installed scenes, not those of the source tree: one of these exists only here.
unset(ENV{WEFT_SCENES})
set(scenes ${prefix}/share/weft/scenes)
file(COPY_FILE ${scenes}/paper/fig6_ball.toml ${scenes}/only_here.toml)
run(output ${prefix}/bin/weft scenes)
expect("${output}" "only_here " "the installed program does not list the installed scenes")
run(output ${prefix}/bin/weft run only_here --frames 2 --out ${WORK}/run)
file(READ ${WORK}/run/report.json program_report)

# The library.
run(output ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/core_only -B ${WORK}/core_only -G ${GENERATOR}
    -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON
    -DCMAKE_DISABLE_FIND_PACKAGE_TinyGLTF=ON -DCMAKE_DISABLE_FIND_PACKAGE_nlohmann_json=ON)
run(output ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/consumer -B ${WORK}/consumer -G ${GENERATOR}
    -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_BUILD_TYPE=${CONFIG} -DCMAKE_PREFIX_PATH=${prefix} -DEXAMPLES=${TREE}/examples)
run(output ${CMAKE_COMMAND} --build ${WORK}/consumer --config ${CONFIG} --parallel 2)
run(output ${WORK}/consumer/bin/hello)
expect("${output}" "^center of mass: -[01]\\.[0-9]+ m\n$" "the program printed in weft.h does not do what it says")
file(GLOB examples ${TREE}/examples/*.cpp)
foreach(example IN LISTS examples)
  get_filename_component(name ${example} NAME_WE)
  run(output ${WORK}/consumer/bin/${name})
  message(STATUS "${name}: ${output}")
endforeach()
if(EXISTS ${WORK}/consumer/bin/draw_world)
  run(output ${WORK}/consumer/bin/draw_world)
  expect("${output}" "^depth: 2 m\n$" "the program with weft::pictures measures another depth")
endif()
run(consumer_report ${WORK}/consumer/bin/run_scene)
foreach(report IN ITEMS program_report consumer_report)
  string(JSON ${report}_hash GET "${${report}}" state_hash)
endforeach()
expect("${consumer_report_hash}" "^${program_report_hash}$" "the library and the program differ in the state's hash")
