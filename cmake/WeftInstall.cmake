# cmake --install: the library with headers and a package for find_package(weft), the program and the scenes.

include(CMakePackageConfigHelpers)

install(TARGETS weft_core EXPORT weft-core-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
set(weft_components core)
if(WEFT_BUILD_SCENE)
  install(TARGETS weft_io weft_scene weft_all EXPORT weft-scene-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
  list(APPEND weft_components scene)
  if(WEFT_BUILD_RENDER)
    install(TARGETS weft_render weft_pictures EXPORT weft-pictures-targets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
    list(APPEND weft_components pictures)
  endif()
  if(WEFT_SHARED)
    install(TARGETS weft_shared EXPORT weft-shared-targets LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
    list(APPEND weft_components shared)
  endif()
endif()
foreach(component IN LISTS weft_components)
  install(EXPORT weft-${component}-targets NAMESPACE weft:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/weft)
endforeach()

install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/weft DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
set(WEFT_INSTALL_SCENES_DIR ${CMAKE_INSTALL_DATADIR}/weft/scenes)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/scenes/ DESTINATION ${WEFT_INSTALL_SCENES_DIR})
if(WEFT_BUILD_APP)
  install(TARGETS weft_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
if(WEFT_BUILD_LAB)
  install(TARGETS weft_lab_app RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

configure_package_config_file(
  ${CMAKE_CURRENT_LIST_DIR}/weft-config.cmake.in ${PROJECT_BINARY_DIR}/weft-config.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/weft PATH_VARS WEFT_INSTALL_SCENES_DIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/weft-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/weft-config.cmake ${PROJECT_BINARY_DIR}/weft-config-version.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/weft)
