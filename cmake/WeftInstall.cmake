# cmake --install: the library with headers and a package for find_package(weft), the program and the scenes.

include(CMakePackageConfigHelpers)

set(weft_targets weft_core)
if(WEFT_BUILD_SCENE)
  list(APPEND weft_targets weft_io weft_scene weft_all)
  if(WEFT_BUILD_RENDER)
    list(APPEND weft_targets weft_render weft_lab)
  endif()
endif()
install(TARGETS ${weft_targets} EXPORT weft-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT weft-targets NAMESPACE weft:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/weft)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/src/weft ${PROJECT_BINARY_DIR}/generated/weft
        DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
set(WEFT_INSTALL_SCENES_DIR ${CMAKE_INSTALL_DATADIR}/weft/scenes)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes/ DESTINATION ${WEFT_INSTALL_SCENES_DIR})
if(WEFT_BUILD_APP)
  install(TARGETS weft_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

configure_package_config_file(
  ${CMAKE_CURRENT_LIST_DIR}/weft-config.cmake.in ${PROJECT_BINARY_DIR}/weft-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/weft PATH_VARS WEFT_INSTALL_SCENES_DIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/weft-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/weft-config.cmake ${PROJECT_BINARY_DIR}/weft-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/weft)
