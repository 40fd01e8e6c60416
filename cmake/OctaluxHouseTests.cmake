# Tests of the house itself, in builds without sanitizers: layers, public headers, symbols, installation.
find_package(Python3 REQUIRED COMPONENTS Interpreter)

olx_test(layers check COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/scripts/check_layers.py ${PROJECT_SOURCE_DIR})

olx_test(parity_rows check COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/scripts/check_parity.py ${PROJECT_SOURCE_DIR})

# Every public header compiles alone, as C17 and as C++17, with both compilers.
file(GLOB headers CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/include/octalux/*.h)
if(NOT OCTALUX_VULKAN)
  list(FILTER headers EXCLUDE REGEX "/vulkan\\.h$")
endif()
foreach(compiler gcc clang)
  find_program(OLX_${compiler} ${compiler})
  foreach(header ${headers})
    get_filename_component(stem ${header} NAME_WE)
    foreach(language c c++)
      set(name header_${stem}_${language}17_${compiler})
      olx_test(${name} check COMMAND ${OLX_${compiler}} -x ${language} -std=${language}17 -Wall -Wextra -Wpedantic -Werror
               -fsyntax-only -I${PROJECT_SOURCE_DIR}/include ${header})
    endforeach()
  endforeach()
endforeach()

set(vulkan_header)
if(OCTALUX_VULKAN)
  set(vulkan_header vulkan.h)
endif()
if(TARGET octalux-shared)
  olx_test(symbols check COMMAND ${Python3_EXECUTABLE} ${PROJECT_SOURCE_DIR}/scripts/check_symbols.py $<$<CONFIG:Debug>:--debug>
           ${PROJECT_SOURCE_DIR}/include/octalux $<TARGET_FILE:octalux-shared> $<TARGET_FILE:octalux> $<TARGET_FILE:octalux-bake>
           $<TARGET_FILE:octalux-bake-shared> ${vulkan_header} COMMAND_EXPAND_LISTS)
endif()

olx_test(install check COMMAND bash ${PROJECT_SOURCE_DIR}/scripts/check_install.sh ${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR})

# Packing and building against the library take a minute of processor time, so the full check runs them.
olx_test(packages full COMMAND bash ${PROJECT_SOURCE_DIR}/scripts/check_packages.sh ${PROJECT_BINARY_DIR} ${PROJECT_SOURCE_DIR})
olx_test(dist check COMMAND bash ${PROJECT_SOURCE_DIR}/scripts/check_dist.sh ${PROJECT_SOURCE_DIR})
set_tests_properties(dist PROPERTIES SKIP_RETURN_CODE 77)

if(OCTALUX_VULKAN)
  olx_test(embed_vulkan full COMMAND bash ${PROJECT_SOURCE_DIR}/scripts/check_embed_vulkan.sh ${PROJECT_BINARY_DIR}
           ${PROJECT_SOURCE_DIR})
endif()
