# The page of `octalux export web`: our modules, with three.js from npm beside them. A build without its tools, or
# without a way to npm, leaves it out and says so; the command then says what is missing.
find_program(OLX_NODE node)
find_program(OLX_NPM npm)
find_program(OLX_WASM_CLANG clang)
find_program(OLX_WASM_LD wasm-ld)
set(OLX_WEB_TOOLS ON)
if(NOT OLX_NODE OR NOT OLX_NPM OR NOT OLX_WASM_CLANG OR NOT OLX_WASM_LD)
  set(OLX_WEB_TOOLS OFF)
endif()
olx_optional_part(OCTALUX_WEB "The page of octalux export web; needs node, npm, clang and lld, and a way to npm" ${OLX_WEB_TOOLS})
if(OCTALUX_WEB AND NOT OLX_WEB_TOOLS)
  message(FATAL_ERROR "OCTALUX_WEB needs node, npm, clang and wasm-ld (Debian: nodejs, npm, clang, lld); -DOCTALUX_WEB=OFF builds without")
elseif(NOT OCTALUX_WEB)
  message(STATUS "Without the page of export web (OCTALUX_WEB is off; it needs node, npm, clang and lld)")
  return()
endif()

set(OLX_WEB_DIR ${PROJECT_BINARY_DIR}/web)
file(GLOB OLX_WEB_SOURCES CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/web/*.mjs ${PROJECT_SOURCE_DIR}/web/src/* ${PROJECT_SOURCE_DIR}/web/page/*
     ${PROJECT_SOURCE_DIR}/web/decoder/*.c ${PROJECT_SOURCE_DIR}/shaders/lib/*.glsl ${PROJECT_SOURCE_DIR}/src/block/bc*)
list(FILTER OLX_WEB_SOURCES EXCLUDE REGEX "/node_modules$")
add_custom_command(
  OUTPUT ${OLX_WEB_DIR}/index.html
  COMMAND bash ${PROJECT_SOURCE_DIR}/web/build_page.sh ${OLX_WEB_DIR} ${PROJECT_BINARY_DIR}/web-packages
  DEPENDS ${OLX_WEB_SOURCES} ${PROJECT_SOURCE_DIR}/shaders/octalux_shared.h ${PROJECT_SOURCE_DIR}/web/build_page.sh
  COMMENT "Building the page of export web" VERBATIM)
add_custom_target(octalux-web ALL DEPENDS ${OLX_WEB_DIR}/index.html)
install(DIRECTORY ${OLX_WEB_DIR}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/octalux/web COMPONENT tools OPTIONAL)
