# Flags of every target. Floating-point contraction stays off so that results do not depend on the instruction set.
set(OLX_SANITIZE "" CACHE STRING "Sanitizers, as -fsanitize= takes them (address,undefined or thread)")
option(OLX_WERROR "Warnings are errors" ON)

add_library(olx_flags INTERFACE)
# Assertions are for debug builds: a library must not end its host. Without a build type there are none either.
target_compile_definitions(olx_flags INTERFACE _GNU_SOURCE $<$<NOT:$<CONFIG:Debug>>:NDEBUG>)
target_compile_options(olx_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wundef -Wvla
  -ffp-contract=off -fno-math-errno -fvisibility=hidden
  $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes -Wmissing-prototypes>
  $<$<BOOL:${OLX_WERROR}>:-Werror>)
if(OLX_SANITIZE)
  target_compile_options(olx_flags INTERFACE -fsanitize=${OLX_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(olx_flags INTERFACE -fsanitize=${OLX_SANITIZE})
endif()
