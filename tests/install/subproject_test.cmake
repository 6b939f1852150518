# cmake -DTREE=… -DWORK=… -DGENERATOR=… -DCXX=… -P subproject_test.cmake
#
# Configures a project that includes the source tree TREE, in every supported way, without the packages that each way
# must not need. subproject/CMakeLists.txt checks the targets.

cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/run.cmake)

function(check_subproject name targets missing_packages)
  set(build ${WORK}/${name})
  file(REMOVE_RECURSE ${build})
  set(disabled "")
  foreach(package IN LISTS missing_packages)
    list(APPEND disabled -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
  endforeach()
  run(output ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/subproject -B ${build} -G ${GENERATOR}
      -DCMAKE_CXX_COMPILER=${CXX} -DTREE=${TREE} -DEXPECTED_TARGETS=${targets} ${disabled} ${ARGN})
  # No install rules: with one, the command would fail because of missing built files, or install a file.
  run(output ${CMAKE_COMMAND} --install ${build} --prefix ${build}/prefix)
  file(GLOB_RECURSE installed ${build}/prefix/*)
  expect("${installed}" "^$" "a subproject installs files")
endfunction()

set(tools GTest CLI11 fmt)
check_subproject(whole "weft_all weft_core weft_io weft_scene" "${tools}")
check_subproject(pictures "weft_all weft_core weft_io weft_pictures weft_render weft_scene" "${tools};glfw3" -DWEFT_BUILD_RENDER=ON)
check_subproject(engine "weft_core" "${tools};TinyGLTF;tomlplusplus;nlohmann_json" -DWEFT_BUILD_SCENE=OFF)
check_subproject(serial "weft_core" "${tools};TBB" -DWEFT_BUILD_SCENE=OFF -DWEFT_WITH_TBB=OFF)
