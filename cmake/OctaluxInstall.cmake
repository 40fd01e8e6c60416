# What `make install` puts where: headers, the static libraries, a CMake package, a pkg-config file. Programs are installed by their folders.
include(CMakePackageConfigHelpers)
set(OLX_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/octalux)
set(OLX_SHADER_DIR ${CMAKE_INSTALL_DATADIR}/octalux/shaders)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/octalux DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.h")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/shaders DESTINATION ${CMAKE_INSTALL_DATADIR}/octalux
        FILES_MATCHING PATTERN "octalux_shared.h" PATTERN "lib/*.glsl" PATTERN "pass" EXCLUDE)
install(TARGETS octalux EXPORT octaluxTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(TARGETS octalux-bake EXPORT octaluxBakeTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT octaluxTargets NAMESPACE octalux:: DESTINATION ${OLX_PACKAGE_DIR})
install(EXPORT octaluxBakeTargets NAMESPACE octalux:: DESTINATION ${OLX_PACKAGE_DIR})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/octaluxConfig.cmake.in ${PROJECT_BINARY_DIR}/octaluxConfig.cmake
                              INSTALL_DESTINATION ${OLX_PACKAGE_DIR} PATH_VARS OLX_SHADER_DIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/octaluxConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/octaluxConfig.cmake ${PROJECT_BINARY_DIR}/octaluxConfigVersion.cmake
        DESTINATION ${OLX_PACKAGE_DIR})

file(RELATIVE_PATH OLX_PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" OLX_PC_PREFIX "${OLX_PC_PREFIX}")
configure_file(${CMAKE_CURRENT_LIST_DIR}/octalux.pc.in ${PROJECT_BINARY_DIR}/octalux.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/octalux.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR})
