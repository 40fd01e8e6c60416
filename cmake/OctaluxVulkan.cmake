# The Vulkan runtime needs Vulkan's headers and glslc to build, and nothing to link: hosts hand it their loader.
find_path(OLX_VULKAN_HEADERS vulkan/vulkan_core.h)
find_program(OLX_GLSLC glslc)
set(OLX_VULKAN_TOOLS ON)
if(NOT OLX_VULKAN_HEADERS OR NOT OLX_GLSLC)
  set(OLX_VULKAN_TOOLS OFF)
endif()
olx_optional_part(OCTALUX_VULKAN "The Vulkan runtime; needs glslc and Vulkan's headers" ${OLX_VULKAN_TOOLS})
if(OCTALUX_VULKAN AND NOT OLX_VULKAN_TOOLS)
  message(FATAL_ERROR "OCTALUX_VULKAN needs glslc and vulkan/vulkan_core.h (Debian: glslc, libvulkan-dev); "
                      "-DOCTALUX_VULKAN=OFF builds without the Vulkan runtime")
elseif(NOT OCTALUX_VULKAN)
  message(STATUS "Without the Vulkan runtime (OCTALUX_VULKAN is off; it needs glslc and vulkan/vulkan_core.h)")
  return()
endif()

set(OLX_SPIRV_DIR ${PROJECT_BINARY_DIR}/spirv)
file(MAKE_DIRECTORY ${OLX_SPIRV_DIR})
file(GLOB OLX_SHADER_LIBRARY CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/shaders/octalux_shared.h
     ${PROJECT_SOURCE_DIR}/shaders/lib/*.glsl ${PROJECT_SOURCE_DIR}/shaders/pass/*.glsl)

# NAME.spv.inc: the words of a shader's SPIR-V, to be included between braces.
function(olx_compile_shader source output)
  get_filename_component(name ${source} NAME_WE)
  add_custom_command(
    OUTPUT ${OLX_SPIRV_DIR}/${name}.spv.inc
    COMMAND ${OLX_GLSLC} --target-env=vulkan1.2 -Werror -mfmt=num -I ${PROJECT_SOURCE_DIR} -I ${PROJECT_SOURCE_DIR}/shaders
            -I ${CMAKE_CURRENT_SOURCE_DIR} ${source} -o ${OLX_SPIRV_DIR}/${name}.spv.inc
    DEPENDS ${source} ${OLX_SHADER_LIBRARY} ${ARGN}
    VERBATIM)
  set(${output} ${OLX_SPIRV_DIR}/${name}.spv.inc PARENT_SCOPE)
endfunction()

file(GLOB passes CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/shaders/pass/*.comp)
foreach(source ${passes})
  olx_compile_shader(${source} spirv)
  list(APPEND OLX_PASS_SPIRV ${spirv})
endforeach()
add_custom_target(octalux-spirv DEPENDS ${OLX_PASS_SPIRV})
