# Flags of every target. Floating-point contraction stays off so that results do not depend on the instruction set.
set(OLX_SANITIZE "" CACHE STRING "Sanitizers, as -fsanitize= takes them (address,undefined or thread)")
option(OLX_FUZZ "Targets of coverage-guided fuzzing, and libraries that count edges and take any checksum: for nothing else" OFF)
option(OLX_WERROR "Warnings are errors" ON)
option(OCTALUX_BAKER "The baker, the programs and the tests; off: the runtime alone, which needs nothing but a C compiler and xxHash" ON)
set(OCTALUX_SYSTEM posix CACHE STRING "Whose files and threads the runtime uses: posix, or plain for C17 alone (docs/architecture.md, Ports)")
set_property(CACHE OCTALUX_SYSTEM PROPERTY STRINGS posix plain)
option(BUILD_SHARED_LIBS "Build liboctalux and liboctalux-bake as shared libraries, and programs that load them" OFF)

add_library(olx_flags INTERFACE)
# Assertions are for debug builds: a library must not end its host. Without a build type there are none either.
target_compile_definitions(olx_flags INTERFACE $<$<STREQUAL:${OCTALUX_SYSTEM},posix>:_GNU_SOURCE> $<$<NOT:$<CONFIG:Debug>>:NDEBUG>)
if(OCTALUX_BAKER AND NOT OCTALUX_SYSTEM STREQUAL posix)
  message(FATAL_ERROR "The baker needs POSIX; OCTALUX_SYSTEM=${OCTALUX_SYSTEM} goes with -DOCTALUX_BAKER=OFF")
endif()
target_compile_options(olx_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wundef -Wvla
  -ffp-contract=off -fno-math-errno
  $<$<COMPILE_LANGUAGE:C>:-Wstrict-prototypes -Wmissing-prototypes>
  $<$<BOOL:${OLX_WERROR}>:-Werror>)
# Functions of no public header are hidden, but where the baker and the tests find them in another library. Calls within
# a library are bound to it either way.
if(BUILD_SHARED_LIBS)
  target_compile_options(olx_flags INTERFACE -fno-semantic-interposition)
  target_link_options(olx_flags INTERFACE -Wl,-Bsymbolic-functions)
else()
  target_compile_options(olx_flags INTERFACE -fvisibility=hidden)
endif()
if(OLX_SANITIZE)
  target_compile_options(olx_flags INTERFACE -fsanitize=${OLX_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  target_link_options(olx_flags INTERFACE -fsanitize=${OLX_SANITIZE})
endif()
if(OLX_FUZZ)
  target_compile_definitions(olx_flags INTERFACE OLX_ANY_CHECKSUM)
  target_compile_options(olx_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()
