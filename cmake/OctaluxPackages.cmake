# Debian packages, one for each component of the installation: `make packages`. Each has a copyright file that names the
# libraries of others (third_party.tsv). They are built where dpkg-shlibdeps and Python are.
find_program(OLX_DPKG_SHLIBDEPS dpkg-shlibdeps)
find_package(Python3 QUIET COMPONENTS Interpreter)
if(NOT OLX_DPKG_SHLIBDEPS OR NOT Python3_FOUND OR BUILD_SHARED_LIBS)
  message(STATUS "Without Debian packages (they need dpkg-dev, python3, and static libraries)")
  return()
endif()

# Packages contain the notices of what is compiled into them, as Debian has them.
file(STRINGS ${PROJECT_SOURCE_DIR}/cmake/third_party.tsv contained REGEX "\tcontains\t")
foreach(row IN LISTS contained)
  if(row MATCHES "^viewer\t" AND NOT TARGET octalux-view)
    continue()
  endif()
  string(REGEX REPLACE "^.*\t" "" package "${row}")
  if(NOT EXISTS /usr/share/doc/${package}/copyright)
    message(STATUS "Without Debian packages: the notice of ${package} is not in /usr/share/doc")
    return()
  endif()
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME octalux)
set(CPACK_PACKAGE_VENDOR "The Octalux authors")
set(CPACK_PACKAGE_CONTACT "The Octalux authors")
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_GROUPING IGNORE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY "=")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

# olx_package COMPONENT NAME SECTION DESCRIPTION [DEPENDS LIST] [RECOMMENDS LIST]: lists are as Debian's control files
# have them.
function(olx_package component name section description)
  cmake_parse_arguments(package "" "DEPENDS;RECOMMENDS" "" ${ARGN})
  string(TOUPPER ${component} upper)
  set(notice ${PROJECT_BINARY_DIR}/notices/${name}/copyright)
  add_custom_command(OUTPUT ${notice}
    COMMAND ${CMAKE_COMMAND} -E make_directory ${PROJECT_BINARY_DIR}/notices/${name}
    COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/scripts/notices.py ${PROJECT_SOURCE_DIR} ${component} ${notice}
    DEPENDS ${PROJECT_SOURCE_DIR}/scripts/notices.py ${PROJECT_SOURCE_DIR}/cmake/third_party.tsv ${PROJECT_SOURCE_DIR}/LICENSE VERBATIM)
  add_custom_target(notice-${component} ALL DEPENDS ${notice})
  install(FILES ${notice} DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${name} COMPONENT ${component})
  set(CPACK_COMPONENTS_ALL ${CPACK_COMPONENTS_ALL} ${component} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${name} PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${section} PARENT_SCOPE)
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${PROJECT_DESCRIPTION}: ${description}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${package_DEPENDS}" PARENT_SCOPE)
  set(CPACK_DEBIAN_${upper}_PACKAGE_RECOMMENDS "${package_RECOMMENDS}" PARENT_SCOPE)
endfunction()

set(OLX_RUNTIME_PACKAGE liboctalux${PROJECT_VERSION_MAJOR})
olx_package(runtime ${OLX_RUNTIME_PACKAGE} libs "the runtime, for programs that load it")
olx_package(dev liboctalux-dev libdevel "headers, shaders and libraries to build programs with"
  DEPENDS "${OLX_RUNTIME_PACKAGE} (= ${PROJECT_VERSION})"
  # What find_package(octalux COMPONENTS bake) looks for, and what octalux/vulkan.h includes; the runtime needs none of it.
  RECOMMENDS "libembree-dev, libassimp-dev, libcjson-dev, libdraco-dev, libmeshoptimizer-dev, libopenexr-dev, libqhull-dev, libwebp-dev, libzstd-dev, zlib1g-dev, libvulkan-dev, pkg-config")
olx_package(tools octalux graphics "the command line, with the baker in it" RECOMMENDS "libvulkan1, mesa-vulkan-drivers | vulkan-icd")
if(TARGET octalux-view)
  olx_package(viewer octalux-viewer graphics "the window of octalux view"
    DEPENDS "octalux (= ${PROJECT_VERSION})" RECOMMENDS "mesa-vulkan-drivers | vulkan-icd")
endif()
if(TARGET octalux-bake-mpi)
  # Open MPI starts a daemon of openmpi-bin even for a program that was started without mpirun.
  olx_package(mpi octalux-mpi graphics "baking on the ranks of an MPI job" DEPENDS "openmpi-bin")
endif()
olx_package(doc octalux-doc doc "documents, examples, the Python package's source")
set(CPACK_DEBIAN_DOC_PACKAGE_ARCHITECTURE all)
include(CPack)
