# What `make install` puts where: headers, libraries, a CMake package, pkg-config files, documents. Programs are
# installed by their folders. Components are Debian's packages (OctaluxPackages.cmake).
include(CMakePackageConfigHelpers)
set(OLX_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/octalux)
set(OLX_SHADER_DIR ${CMAKE_INSTALL_DATADIR}/octalux/shaders)

install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/octalux DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev FILES_MATCHING PATTERN "*.h")
install(DIRECTORY ${PROJECT_SOURCE_DIR}/shaders DESTINATION ${CMAKE_INSTALL_DATADIR}/octalux COMPONENT dev
        FILES_MATCHING PATTERN "octalux_shared.h" PATTERN "lib/*.glsl" PATTERN "pass" EXCLUDE)
set(OLX_RUNTIME_LIBRARIES octalux)
if(TARGET octalux-shared)
  list(APPEND OLX_RUNTIME_LIBRARIES octalux-shared)
endif()
set(OLX_LIBRARY_PLACES ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
                       LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT dev)
install(TARGETS ${OLX_RUNTIME_LIBRARIES} EXPORT octaluxTargets ${OLX_LIBRARY_PLACES})
install(EXPORT octaluxTargets NAMESPACE octalux:: DESTINATION ${OLX_PACKAGE_DIR} COMPONENT dev)
if(OCTALUX_BAKER)
  install(TARGETS octalux-bake EXPORT octaluxBakeTargets ${OLX_LIBRARY_PLACES})
  install(EXPORT octaluxBakeTargets NAMESPACE octalux:: DESTINATION ${OLX_PACKAGE_DIR} COMPONENT dev)
endif()
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/octaluxConfig.cmake.in ${PROJECT_BINARY_DIR}/octaluxConfig.cmake
                              INSTALL_DESTINATION ${OLX_PACKAGE_DIR} PATH_VARS OLX_SHADER_DIR)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/octaluxConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/octaluxConfig.cmake ${PROJECT_BINARY_DIR}/octaluxConfigVersion.cmake
        DESTINATION ${OLX_PACKAGE_DIR} COMPONENT dev)

file(RELATIVE_PATH OLX_PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
string(REGEX REPLACE "/$" "" OLX_PC_PREFIX "${OLX_PC_PREFIX}")
if(BUILD_SHARED_LIBS)
  set(OLX_BAKE_PC_REQUIRES "Requires: octalux")
  set(OLX_BAKE_PC_LIBS "-L\${libdir} -loctalux-bake")
else()
  # The static runtime, because the shared one does not show what the baker uses of it. Embree 3 and meshoptimizer have
  # no pkg-config files.
  set(OLX_BAKE_PC_REQUIRES "Requires: assimp draco libcjson qhull_r libwebp libzstd OpenEXR zlib")
  set(OLX_BAKE_PC_LIBS "-L\${libdir} -l:liboctalux-bake.a -l:liboctalux.a -lembree3 -lmeshoptimizer -lstdc++ -lm -pthread")
endif()
set(OLX_PC_FILES octalux)
if(OCTALUX_BAKER)
  list(APPEND OLX_PC_FILES octalux-bake)
endif()
foreach(package ${OLX_PC_FILES})
  configure_file(${CMAKE_CURRENT_LIST_DIR}/${package}.pc.in ${PROJECT_BINARY_DIR}/${package}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/${package}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
endforeach()

# What the README links to lies beside it as in the checkout.
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_SOURCE_DIR}/README.md ${PROJECT_SOURCE_DIR}/CHANGELOG.md
        ${PROJECT_SOURCE_DIR}/CONTRIBUTING.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT doc)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs ${PROJECT_SOURCE_DIR}/examples ${PROJECT_SOURCE_DIR}/python DESTINATION ${CMAKE_INSTALL_DOCDIR}
        COMPONENT doc PATTERN __pycache__ EXCLUDE)
